// A recording with the ending .sigmf: a tar.

#include <cstdint>
#include <string_view>

#include "tests/fuzz/memory_folder.hpp"
#include "tests/fuzz/recording_claims.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace hertzline;
    static const fuzz::MemoryFolder folder;
    folder.hold("x.sigmf", {reinterpret_cast<const char*>(data), size});
    fuzz::claim_recording_or_fault(folder.file("x.sigmf"));
    return 0;
}
