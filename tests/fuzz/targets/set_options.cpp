// The arguments of --set options, each ended by a NUL as in a process's command line.

#include <algorithm>
#include <cstdint>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "core/scene/scene_fields.hpp"
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

struct Values {
    std::vector<std::pair<std::string, std::string>>& of_keys;

    template <class Member, class Allowed>
    void operator()(const fields::Key& key, const std::optional<Member>& member,
                    const Allowed& allowed) const {
        if (member) {
            (*this)(key, *member, allowed);
        } else {
            of_keys.emplace_back(key.text(), "");
        }
    }
    template <class Member, class Allowed>
    void operator()(const fields::Key& key, const Member& member, const Allowed& /*allowed*/) const {
        if constexpr (std::is_same_v<Member, std::string>) {
            of_keys.emplace_back(key.text(), member);
        } else if constexpr (std::is_enum_v<Member>) {
            of_keys.emplace_back(key.text(), word(member));
        } else {
            of_keys.emplace_back(key.text(), number_text(member));
        }
    }
};

std::vector<std::pair<std::string, std::string>> values_of(const Scene& scene) {
    std::vector<std::pair<std::string, std::string>> values;
    fields::visit_scene(scene, Values{values});
    return values;
}

/// No option sets another key than the one before its '='.
void claim_nothing_else_is_set(const Scene& scene, const std::vector<std::string>& options) {
    const auto defaults = values_of(Scene{});
    const auto values = values_of(scene);
    for (std::size_t i = 0; i < values.size(); ++i) {
        const auto& [key, value] = values[i];
        const bool named = std::any_of(options.begin(), options.end(), [&key = key](const auto& option) {
            return option.substr(0, option.find('=')).find(key) != std::string::npos;
        });
        claim(named || value == defaults[i].second, "an option sets its own key alone", key);
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
