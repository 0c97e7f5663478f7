#pragma once
// The one table of what a scene file may hold: each key, the member that it sets and what is allowed there.
// Reading, writing, validation and the list of known keys are all visits of this table.
//
// A visitor is called as visit(Key, member, allowed). `member` is the value or a std::optional of it;
// `allowed` is one of the four types below, and tells the visitor the value's type as well.
//
// The structured bindings name every member of a section, so a member without a row does not compile.
//
// The bounds are generous. They are there so that no product of allowed numbers overflows, and so that sample
// and step counts (duration times 1e12 at most) fit 63 bits; not to say what is a sensible device.

#include <cstdint>
#include <string>
#include <string_view>

#include "core/scene/scene.hpp"
#include "core/scene/scene_words.hpp"
#include "core/scene/text.hpp"

namespace hertzline::fields {

/// A key and the section that it stands in, for a material "materials.NAME".
struct Key {
    std::string_view section;
    std::string_view name;

    /// "chain.spheres"
    std::string text() const { return std::string(section) + '.' + std::string(name); }
};

enum class Bounds { included, excluded };

/// The numbers that a key allows.
struct Range {
    double min;
    double max;
    std::string_view unit;
    Bounds bounds = Bounds::included;
};

/// The integers that a key allows, both ends included.
struct Count {
    std::int64_t min;
    std::int64_t max;
};

/// The member is the name of a material of this sort.
enum class MaterialSort { solid, fluid };

/// The member is one of the words for a Choice.
template <class Choice>
struct OneOf {};

inline std::string allowed_text(const Range& range) {
    const bool included = range.bounds == Bounds::included;
    return (included ? "a number from " : "a number above ") + number_text(range.min) +
           (included ? " to " : " and below ") + number_text(range.max) + (range.unit.empty() ? "" : " ") +
           std::string(range.unit);
}

inline std::string allowed_text(const Count& count) {
    return "an integer from " + number_text(count.min) + " to " + number_text(count.max);
}

inline std::string allowed_text(MaterialSort sort) {
    return sort == MaterialSort::solid ? "the name of a solid" : "the name of a fluid";
}

template <class Choice>
std::string allowed_text(OneOf<Choice> /*words*/) {
    std::string text;
    for (const auto& entry : Words<Choice>::all) {
        text += (text.empty() ? "" : ", ") + quoted(entry.text);
    }
    return "one of " + text;
}

template <class AnyScene, class Visit>
void visit_scene(AnyScene& scene, Visit&& visit) {
    const auto solid = MaterialSort::solid;
    const auto length = Range{1e-9, 10, "m"};
    {
        auto& [material, frequency_hz, cycles, amplitude_m, envelope, taper, repetition_hz] = scene.drive;
        visit(Key{"drive", "material"}, material, solid);
        visit(Key{"drive", "frequency_hz"}, frequency_hz, Range{1e-3, 1e9, "Hz"});
        visit(Key{"drive", "cycles"}, cycles, Range{1e-3, 1e9, ""});
        visit(Key{"drive", "amplitude_m"}, amplitude_m, Range{0, 1, "m"});
        visit(Key{"drive", "envelope"}, envelope, OneOf<Envelope>{});
        visit(Key{"drive", "taper"}, taper, Range{0, 1, ""});
        visit(Key{"drive", "repetition_hz"}, repetition_hz, Range{0, 1e9, "Hz"});
    }
    {
        auto& [material, spheres, diameter_m, damping_kg_per_s, damping_law, damping_time_s, damping_alpha,
               preload_n, tension] = scene.chain;
        visit(Key{"chain", "material"}, material, solid);
        visit(Key{"chain", "spheres"}, spheres, Count{1, max_spheres});
        visit(Key{"chain", "diameter_m"}, diameter_m, length);
        visit(Key{"chain", "damping_kg_per_s"}, damping_kg_per_s, Range{0, 1e9, "kg/s"});
        visit(Key{"chain", "damping_law"}, damping_law, OneOf<DampingLaw>{});
        visit(Key{"chain", "damping_time_s"}, damping_time_s, Range{0, 1, "s"});
        visit(Key{"chain", "damping_alpha"}, damping_alpha, Range{0, 10, ""});
        visit(Key{"chain", "preload_n"}, preload_n, Range{0, 1e9, "N"});
        visit(Key{"chain", "tension"}, tension, OneOf<Tension>{});
    }
    {
        auto& [kind, material, radius_m, thickness_m, stiffness_n_per_m, preload, model, modes, loss_factor] =
            scene.end;
        visit(Key{"end", "kind"}, kind, OneOf<EndKind>{});
        visit(Key{"end", "material"}, material, solid);
        visit(Key{"end", "radius_m"}, radius_m, length);
        visit(Key{"end", "thickness_m"}, thickness_m, length);
        visit(Key{"end", "stiffness_n_per_m"}, stiffness_n_per_m, Range{0, 1e15, "N/m"});
        visit(Key{"end", "preload"}, preload, OneOf<PlatePreload>{});
        visit(Key{"end", "model"}, model, OneOf<PlateModel>{});
        visit(Key{"end", "modes"}, modes, Count{1, 6});
        visit(Key{"end", "loss_factor"}, loss_factor, Range{1e-6, 1, ""});
    }
    {
        auto& [material, load] = scene.medium;
        visit(Key{"medium", "material"}, material, MaterialSort::fluid);
        visit(Key{"medium", "load"}, load, OneOf<FluidLoad>{});
    }
    {
        auto& [integrator, step_s, accuracy, rest_tolerance, poles] = scene.numerics;
        visit(Key{"numerics", "integrator"}, integrator, OneOf<Integrator>{});
        visit(Key{"numerics", "step_s"}, step_s, Range{1e-12, 1, "s"});
        visit(Key{"numerics", "accuracy"}, accuracy, Range{1e-15, 0.1, ""});
        visit(Key{"numerics", "rest_tolerance"}, rest_tolerance, Range{0, 0.01, ""});
        visit(Key{"numerics", "poles"}, poles, Count{16, 64});
    }
    {
        auto& [sample_rate_hz, duration_s, frame_samples, hydrophone_m] = scene.output;
        visit(Key{"output", "sample_rate_hz"}, sample_rate_hz, Range{1e-3, 1e12, "Hz"});
        visit(Key{"output", "duration_s"}, duration_s, Range{1e-12, 1e6, "s"});
        visit(Key{"output", "frame_samples"}, frame_samples, Count{1, 1'048'576});
        visit(Key{"output", "hydrophone_m"}, hydrophone_m, Range{0, 10, "m"});
    }
}

inline constexpr Range density_range{1e-3, 1e6, "kg/m^3"};

/// The same for the keys of a solid in `section`, [materials.NAME].
template <class AnySolid, class Visit>
void visit_solid(AnySolid& solid, std::string_view section, Visit&& visit) {
    auto& [youngs_modulus_pa, poissons_ratio, density_kg_per_m3, yield_strength_pa, flexural_strength_pa] =
        solid;
    visit(Key{section, "youngs_modulus_pa"}, youngs_modulus_pa, Range{1, 1e15, "Pa"});
    visit(Key{section, "poissons_ratio"}, poissons_ratio, Range{-1, 0.5, "", Bounds::excluded});
    visit(Key{section, "density_kg_per_m3"}, density_kg_per_m3, density_range);
    visit(Key{section, "yield_strength_pa"}, yield_strength_pa, Range{1, 1e15, "Pa"});
    visit(Key{section, "flexural_strength_pa"}, flexural_strength_pa, Range{1, 1e15, "Pa"});
}

template <class AnyFluid, class Visit>
void visit_fluid(AnyFluid& fluid, std::string_view section, Visit&& visit) {
    auto& [density_kg_per_m3, sound_speed_m_per_s] = fluid;
    visit(Key{section, "density_kg_per_m3"}, density_kg_per_m3, density_range);
    visit(Key{section, "sound_speed_m_per_s"}, sound_speed_m_per_s, Range{1e-3, 1e6, "m/s"});
}

}  // namespace hertzline::fields
