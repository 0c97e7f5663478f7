#include "hertzline/scene.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <stdexcept>
#include <utility>

#include "core/scene/elements.hpp"
#include "core/scene/scene_key.hpp"
#include "core/scene/scene_words.hpp"
#include "core/scene/text.hpp"

namespace hertzline {

namespace {

bool is_material_name(std::string_view name) {
    constexpr std::size_t max_length = 64;
    return is_bare_key(name) && name.size() <= max_length;
}

/// The faults of each value on its own.
void check_values(const Scene& scene, std::span<const SceneKey> keys, std::vector<Fault>& faults) {
    for (const SceneKey& key : keys) {
        const auto value = key.value(scene);
        if (auto fault = value ? value_fault(scene, key, *value) : std::nullopt) {
            faults.push_back(*std::move(fault));
        }
    }
}

void check_combinations(const Scene& scene, std::vector<Fault>& faults) {
    // of a tone: those of a record are for drive_faults() to find
    const bool is_sampled = scene.drive.kind == DriveKind::file || scene.drive.kind == DriveKind::live;
    const double burst_rate_hz = is_sampled ? 0 : scene.drive.frequency_hz / scene.drive.cycles;
    // Without a positive rate the frequency or the cycles are at fault.
    if (burst_rate_hz > 0 && scene.drive.repetition_hz > burst_rate_hz) {
        faults.push_back({"drive.repetition_hz", number_text(scene.drive.repetition_hz),
                          "at most frequency_hz / cycles = " + number_text(burst_rate_hz) +
                              " Hz, so that bursts do not overlap"});
    }
    const double period_s = 1 / scene.drive.repetition_hz;  // infinite for a single burst
    if (burst_rate_hz > 0 && scene.drive.repetition_hz <= burst_rate_hz && scene.drive.start_s > 0 &&
        scene.drive.start_s + 1 / burst_rate_hz > period_s) {
        faults.push_back({"drive.start_s", number_text(scene.drive.start_s),
                          "at most 1 / repetition_hz - cycles / frequency_hz = " +
                              number_text(period_s - 1 / burst_rate_hz) +
                              " s: a burst lies within its period"});
    }
    if (scene.drive.kind == DriveKind::none && scene.drive.repetition_hz != 0) {
        faults.push_back({"drive.repetition_hz",
                          number_text(scene.drive.repetition_hz) + " with drive.kind = \"none\"",
                          "0: there is no horn to repeat its bursts"});
    }
    if (is_sampled && scene.drive.scale == 0.0) {
        faults.push_back({"drive.scale", "0", "a number other than 0"});
    }
    if (scene.chain.impact_spheres > std::max<std::int64_t>(1, scene.chain.spheres)) {
        faults.push_back({"chain.impact_spheres", number_text(scene.chain.impact_spheres),
                          "at most chain.spheres = " + number_text(scene.chain.spheres)});
    }
    if (scene.numerics.step_s && scene.numerics.accuracy) {
        faults.push_back({"numerics.accuracy",
                          number_text(*scene.numerics.accuracy) + " together with step_s",
                          "either step_s or accuracy, not both"});
    }
}

/// A modal plate follows from its modes: keys that would contradict them are refused.
void check_modal_plate(const Scene& scene, std::vector<Fault>& faults) {
    if (scene.end.model != PlateModel::modal) {
        return;
    }
    const auto note = [&faults](const char* key, std::string found, std::string allowed) {
        faults.push_back({key, std::move(found), std::move(allowed)});
    };
    if (scene.end.kind != EndKind::plate) {
        note("end.model", R"("modal" with end.kind = )" + quoted(word(scene.end.kind)),
             R"("lumped": only a plate has modes)");
    }
    if (scene.end.stiffness_n_per_m) {
        note("end.stiffness_n_per_m",
             number_text(*scene.end.stiffness_n_per_m) + R"( with end.model = "modal")",
             "none: the modes' stiffnesses follow from the disc");
    }
    if (scene.end.preload != PlatePreload::balanced) {
        note("end.preload", quoted(word(scene.end.preload)) + R"( with end.model = "modal")",
             R"("balanced")");
    }
    if (scene.numerics.integrator && !is_series(*scene.numerics.integrator)) {
        note("numerics.integrator", quoted(word(*scene.numerics.integrator)) + R"( with end.model = "modal")",
             R"("taylor8" or "taylor12", the series)");
    }
    constexpr double most_samples = 1e7;  // on the way to the hydrophone
    const auto* fluid = find_material(scene, scene.medium.material);
    const auto* medium = fluid == nullptr ? nullptr : std::get_if<Fluid>(fluid);
    const auto is_far = [&](double way_m) {
        return medium != nullptr &&
               way_m / medium->sound_speed_m_per_s * scene.output.sample_rate_hz > most_samples;
    };
    const std::string near = "at most " + number_text(most_samples) + " samples away at the speed of sound";
    if (is_far(scene.output.hydrophone_m)) {
        note("output.hydrophone_m", number_text(scene.output.hydrophone_m), near);
    }
    for (std::size_t i = 0; i < scene.output.points_m.size(); ++i) {
        const auto& [x, y, z] = scene.output.points_m[i];
        const std::string point = "output.points_m[" + number_text(static_cast<std::int64_t>(i) + 1) + "]";
        if (z < 0) {
            faults.push_back(
                {point + "[3]", number_text(z), "at least 0: the medium lies where z is positive"});
        }
        if (is_far(std::hypot(x, y, z))) {
            faults.push_back({point, number_text(std::hypot(x, y, z)) + " m from the plate's centre", near});
        }
    }
}

/// A resonant horn needs an integrator that knows it.
void check_horn(const Scene& scene, std::vector<Fault>& faults) {
    if (scene.drive.kind != DriveKind::none && scene.drive.horn == HornModel::resonator &&
        scene.numerics.integrator && !is_series(*scene.numerics.integrator)) {
        faults.push_back({"numerics.integrator",
                          quoted(word(*scene.numerics.integrator)) + R"( with drive.horn = "resonator")",
                          R"("taylor8" or "taylor12")"});
    }
}

/// A law other than the dashpot needs its coefficient, and an integrator that knows it.
void check_damping_law(const Scene& scene, std::vector<Fault>& faults) {
    const DampingLaw law = scene.chain.damping_law;
    const std::string with_law = " with chain.damping_law = " + quoted(word(law));
    const auto need = [&](DampingLaw concerned, const char* key, const std::optional<double>& coefficient,
                          const char* allowed) {
        if (law == concerned && !coefficient) {
            faults.push_back({key, "nothing" + with_law, allowed});
        }
    };
    need(DampingLaw::kuwabara_kono, "chain.damping_time_s", scene.chain.damping_time_s,
         "a number of seconds, the law's A");
    need(DampingLaw::tsuji, "chain.damping_alpha", scene.chain.damping_alpha, "a number, the law's alpha");
    if (law != DampingLaw::dashpot && scene.numerics.integrator && !is_series(*scene.numerics.integrator)) {
        faults.push_back({"numerics.integrator", quoted(word(*scene.numerics.integrator)) + with_law,
                          R"("taylor8" or "taylor12")"});
    }
}

/// Layers have a material and a thickness each.
void check_layers(const Scene& scene, std::vector<Fault>& faults) {
    const End& end = scene.end;
    const auto check = [&](const char* key, std::size_t count, const char* other, std::size_t others) {
        const auto text = [](std::size_t number) { return number_text(static_cast<std::int64_t>(number)); };
        if (count != others) {
            faults.push_back({key,
                              (count == 0 ? "nothing" : text(count) + (count == 1 ? " entry" : " entries")) +
                                  " with " + other + " of " + text(others),
                              others == 0 ? "none, or as many entries of " + std::string(other)
                                          : text(others) + ", one for each layer"});
        }
    };
    if (end.materials.empty()) {
        check("end.materials", 0, "end.thicknesses_m", end.thicknesses_m.size());
    } else {
        check("end.thicknesses_m", end.thicknesses_m.size(), "end.materials", end.materials.size());
    }
    if (!end.loss_factors.empty()) {
        check("end.loss_factors", end.loss_factors.size(), "end.materials", end.materials.size());
    }
}

void check_materials(const Scene& scene, std::vector<Fault>& faults) {
    for (const auto& [name, material] : scene.materials) {
        const std::string section = "materials." + key_part(name);
        if (!is_material_name(name)) {
            faults.push_back(
                {section, quoted_briefly(name), "a name of 1 to 64 letters, digits, '_' and '-'"});
        }
        check_values(scene, material_keys(name, material), faults);
    }
}

}  // namespace

std::vector<Fault> validate(const Scene& scene) {
    std::vector<Fault> faults;
    check_values(scene, scene_keys(), faults);
    check_combinations(scene, faults);
    check_modal_plate(scene, faults);
    check_damping_law(scene, faults);
    check_horn(scene, faults);
    check_layers(scene, faults);
    if (faults.empty()) {
        check_array(scene, faults);
    }
    check_materials(scene, faults);
    return faults;
}

ResolvedScene::ResolvedScene(Scene scene) : scene_(std::move(scene)) {
    if (!scene_.numerics.integrator || !scene_.numerics.step_s) {
        throw std::invalid_argument(
            "numerics.integrator or numerics.step_s of a scene to be simulated is open: resolve() chooses "
            "them");
    }
}

const Material* find_material(const Scene& scene, std::string_view name) {
    if (const auto own = scene.materials.find(std::string(name)); own != scene.materials.end()) {
        return &own->second;
    }
    const auto built_in = built_in_materials();
    const auto found =
        std::find_if(built_in.begin(), built_in.end(), [&](const auto& m) { return m.name == name; });
    return found != built_in.end() ? &found->material : nullptr;
}

std::vector<std::string> material_names(const Scene& scene, MaterialSort sort) {
    std::vector<std::string> names;
    for (const BuiltInMaterial& built_in : built_in_materials()) {
        if (sort_of(built_in.material) == sort && !scene.materials.contains(std::string(built_in.name))) {
            names.emplace_back(built_in.name);
        }
    }
    for (const auto& [name, material] : scene.materials) {
        if (sort_of(material) == sort && is_material_name(name)) {
            names.push_back(name);
        }
    }
    return names;
}

const Solid& solid_of(const Scene& scene, std::string_view name) {
    const Material* const material = find_material(scene, name);
    const Solid* const solid = material != nullptr ? std::get_if<Solid>(material) : nullptr;
    if (solid == nullptr) {
        throw std::out_of_range(quoted_briefly(name) + " is no solid of the scene");
    }
    return *solid;
}

}  // namespace hertzline
