#include "core/scene/unused_keys.hpp"

#include <algorithm>
#include <span>
#include <string_view>

#include "core/scene/scene_key.hpp"
#include "core/scene/text.hpp"

namespace hertzline {

namespace {

/// "tone", "file" or "live"
std::string one_of_quoted(std::span<const std::string_view> words) {
    std::string text;
    for (std::size_t i = 0; i < words.size() && !words[i].empty(); ++i) {
        const bool last = i + 1 == words.size() || words[i + 1].empty();
        text += (i == 0 ? "" : last ? " or " : ", ") + hertzline::quoted(words[i]);
    }
    return text;
}

/// Keys that were changed although nothing asks for them.
void warn_of_unused_keys(const Scene& scene, std::vector<std::string>& warnings) {
    const Scene untouched;
    for (const SceneKey& key : scene_keys()) {
        if (key.value(scene) == key.value(untouched) || key.has_effect(scene)) {
            continue;
        }
        const SceneKey* const list = key.replacement(scene);
        warnings.push_back(key.name + " has no effect " +
                           (key.lacks_array(scene) ? "without array.x_m"
                            : list != nullptr      ? "beside " + list->name
                                                   : "without " + std::string(key.traits.needs.key) + " = " +
                                                    one_of_quoted(key.traits.needs.words)));
    }
}

/// The same of keys that need a number.
void warn_of_unused_numbers(const Scene& scene, std::vector<std::string>& warnings) {
    const auto& chain = scene.chain;
    const auto untouched = Scene().chain;
    const bool preloaded = chain.preload_n != 0 || !scene.array.preloads_n.empty();
    if (chain.impact_spheres != untouched.impact_spheres && chain.impact_velocity_m_per_s == 0) {
        warnings.emplace_back("chain.impact_spheres has no effect without chain.impact_velocity_m_per_s");
    }
    if (chain.seed != untouched.seed && chain.tolerance == 0 && chain.preload_tolerance == 0) {
        warnings.emplace_back("chain.seed has no effect without chain.tolerance or chain.preload_tolerance");
    }
    if (chain.preload_tolerance != 0 && !preloaded) {
        warnings.emplace_back("chain.preload_tolerance has no effect without chain.preload_n");
    }
    const bool sampled = scene.drive.kind == DriveKind::file || scene.drive.kind == DriveKind::live;
    if (scene.drive.horn == HornModel::resonator && sampled && scene.drive.horn_mass_kg == 0) {
        warnings.emplace_back(
            "drive.horn = \"resonator\" has no effect with recorded or live samples, which are the tip's "
            "free "
            "motion, and a drive.horn_mass_kg of 0, on which the chain does not act");
    }
    if (scene.numerics.rest_tolerance != 0) {
        const bool resonates =
            scene.drive.kind != DriveKind::none && scene.drive.horn == HornModel::resonator;
        const bool unbalanced =
            scene.end.kind == EndKind::plate && scene.end.preload == PlatePreload::as_printed;
        const char* const why = !preloaded   ? "without chain.preload_n"
                                : resonates  ? "with drive.horn = \"resonator\", which rings"
                                : unbalanced ? "with end.preload = \"as_printed\", which lets the disc swing"
                                             : nullptr;
        if (why != nullptr) {
            warnings.push_back(std::string("numerics.rest_tolerance has no effect ") + why);
        }
    }
}

/// Lists that are longer than the chain.
void warn_of_unused_entries(const Scene& scene, std::vector<std::string>& warnings) {
    const auto check = [&](const char* key, std::size_t entries) {
        const auto count = static_cast<std::int64_t>(entries);
        const std::string spheres = number_text(scene.chain.spheres);
        if (count > scene.chain.spheres) {
            warnings.push_back(std::string(key) + " has " + number_text(count) +
                               " entries, of which the chain of " + spheres + " spheres uses " + spheres);
        }
    };
    check("chain.materials", scene.chain.materials.size());
    check("chain.diameters_m", scene.chain.diameters_m.size());
}

}  // namespace

std::vector<std::string> unused_key_warnings(const Scene& scene) {
    std::vector<std::string> warnings;
    warn_of_unused_keys(scene, warnings);
    warn_of_unused_numbers(scene, warnings);
    warn_of_unused_entries(scene, warnings);
    return warnings;
}

}  // namespace hertzline
