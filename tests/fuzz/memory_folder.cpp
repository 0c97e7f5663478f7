#include "tests/fuzz/memory_folder.hpp"

#include <array>
#include <cstdlib>

#include <fcntl.h>
#include <unistd.h>

#include "tests/fuzz/claim.hpp"

namespace hertzline::fuzz {

MemoryFolder::MemoryFolder() {
    auto name = std::to_array("/dev/shm/hertzline-fuzz-XXXXXX");
    claim(::mkdtemp(name.data()) != nullptr, "there is memory for files");
    folder_ = name.data();
}

MemoryFolder::~MemoryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
}

void MemoryFolder::hold(const std::string& name, std::string_view bytes) const {
    const int descriptor = ::open(file(name).c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
    const bool held = descriptor >= 0 &&
                      ::write(descriptor, bytes.data(), bytes.size()) == static_cast<ssize_t>(bytes.size());
    claim(held, "there is memory for files");
    ::close(descriptor);
}

}  // namespace hertzline::fuzz
