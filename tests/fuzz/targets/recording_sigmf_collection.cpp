// A SigMF collection; the two recordings beside it are always the same.

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "tests/fuzz/memory_folder.hpp"
#include "tests/fuzz/recording_claims.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace hertzline;
    static const fuzz::MemoryFolder folder;
    constexpr std::string_view meta = R"({"global": {"core:datatype": "rf32_le", "core:sample_rate": 1000},
        "captures": [{"core:sample_start": 0}, {"core:sample_start": 9, "core:global_index": 20}]})";
    constexpr std::array<char, 4 * 20> samples{};
    for (const std::string name : {"x-a", "x-b"}) {
        const std::size_t bytes = name == "x-a" ? samples.size() : samples.size() - 17;
        folder.hold(name + ".sigmf-data", {samples.data(), bytes});
        folder.hold(name + ".sigmf-meta", meta);
    }
    folder.hold("x.sigmf-collection", {reinterpret_cast<const char*>(data), size});
    fuzz::claim_recording_or_fault(folder.file("x.sigmf-collection"));
    return 0;
}
