// A recording with the ending .csv, and after the first NUL its metadata, if there is one.

#include <cstdint>
#include <string_view>

#include "tests/fuzz/memory_folder.hpp"
#include "tests/fuzz/recording_claims.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace hertzline;
    const std::string_view input(reinterpret_cast<const char*>(data), size);
    const std::size_t end = input.find('\0');
    static const fuzz::MemoryFolder alone;
    static const fuzz::MemoryFolder described;
    const fuzz::MemoryFolder& folder = end == std::string_view::npos ? alone : described;
    folder.hold("x.csv", input.substr(0, end));
    if (end != std::string_view::npos) {
        folder.hold("x.csv-metadata.json", input.substr(end + 1));
    }
    fuzz::claim_recording_or_fault(folder.file("x.csv"));
    return 0;
}
