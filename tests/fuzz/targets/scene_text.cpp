// The text of a scene file.

#include <cstdint>
#include <string_view>

#include "tests/fuzz/scene_claims.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    hertzline::fuzz::claim_scene_or_faults(hertzline::parse_scene(text, "scene.toml"));
    return 0;
}
