// The arguments of --set options, each ended by a NUL as in a process's command line.

#include <algorithm>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/scene/scene_key.hpp"
#include "tests/fuzz/claim.hpp"
#include "tests/fuzz/scene_claims.hpp"

namespace hertzline::fuzz {

namespace {

std::vector<std::string> options_of(std::string_view text) {
    constexpr std::size_t most = 8;
    std::vector<std::string> options;
    while (!text.empty() && options.size() < most) {
        const std::size_t end = std::min(text.find('\0'), text.size());
        options.emplace_back(text.substr(0, end));
        text.remove_prefix(std::min(end + 1, text.size()));
    }
    return options;
}

/// No option sets another key than the one before its '='.
void claim_nothing_else_is_set(const Scene& scene, const std::vector<std::string>& options) {
    for (const SceneKey& key : scene_keys()) {
        const bool named = std::any_of(options.begin(), options.end(), [&](const auto& option) {
            return option.substr(0, option.find('=')).find(key.name) != std::string::npos;
        });
        claim(named || key.value(scene) == key.value(Scene{}), "an option sets its own key alone", key.name);
    }
}

}  // namespace

}  // namespace hertzline::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace hertzline;
    const auto options = fuzz::options_of({reinterpret_cast<const char*>(data), size});
    const auto result = parse_scene("", "scene.toml", options);
    fuzz::claim_scene_or_faults(result);
    static const std::string every_default = to_toml(Scene{});
    const auto over_a_file = parse_scene(every_default, "scene.toml", options);
    fuzz::claim(
        over_a_file.has_value() == result.has_value() && (!result || over_a_file->scene == result->scene),
        "an option means the same beside any file");
    if (result) {
        fuzz::claim_nothing_else_is_set(result->scene, options);
    }
    return 0;
}
