// The metadata of a SigMF recording; its data are always the same.

#include <array>
#include <cstdint>
#include <string_view>

#include "tests/fuzz/memory_folder.hpp"
#include "tests/fuzz/recording_claims.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace hertzline;
    static const fuzz::MemoryFolder folder;
    constexpr std::array<char, 4 * 60 + 1>
        samples{};  // many numbers of channels divide 60; and a byte too many
    folder.hold("x.sigmf-data", {samples.data(), samples.size()});
    folder.hold("x.sigmf-meta", {reinterpret_cast<const char*>(data), size});
    fuzz::claim_recording_or_fault(folder.file("x.sigmf-meta"));
    return 0;
}
