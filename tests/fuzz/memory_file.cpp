#include "tests/fuzz/memory_file.hpp"

#include <array>
#include <cstdlib>
#include <string>

#include <fcntl.h>
#include <unistd.h>

#include "tests/fuzz/claim.hpp"

namespace hertzline::fuzz {

namespace fs = std::filesystem;

MemoryFile::MemoryFile(const char* name) {
    std::array folder = std::to_array("/dev/shm/hertzline-fuzz-XXXXXX");
    claim(::mkdtemp(folder.data()) != nullptr, "there is memory for a file");
    folder_ = folder.data();
    path_ = folder_ / name;
    descriptor_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
    claim(descriptor_ >= 0, "there is memory for a file");
}

MemoryFile::~MemoryFile() {
    ::close(descriptor_);
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
}

void MemoryFile::hold(const std::uint8_t* data, std::size_t size) const {
    const bool held = ::ftruncate(descriptor_, 0) == 0 &&
                      ::pwrite(descriptor_, data, size, 0) == static_cast<ssize_t>(size);
    claim(held, "there is memory for a file");
}

}  // namespace hertzline::fuzz
