// A recording with the ending .h5.

#include <cstdint>
#include <string_view>

#include "tests/fuzz/memory_folder.hpp"
#include "tests/fuzz/recording_claims.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace hertzline;
    static const fuzz::MemoryFolder folder;
    folder.hold("x.h5", {reinterpret_cast<const char*>(data), size});
    fuzz::claim_recording_or_fault(folder.file("x.h5"));
    return 0;
}
