#include "tests/support/design_scene.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>
#include <utility>

#include "core/integrators/stability.hpp"
#include "core/model/chain.hpp"
#include "core/model/drive.hpp"
#include "core/model/end.hpp"
#include "core/model/horn.hpp"
#include "core/scene/elements.hpp"
#include "core/scene/scene_words.hpp"
#include "tests/support/draw.hpp"

namespace hertzline::test {

namespace {

enum class Kind { near_paper, short_chain, long_chain };

/// Solids that are not built in, with usual values.
const std::array<std::pair<std::string, Solid>, 9> own_solids{{
    {"brass", {105e9, 0.34, 8500}},
    {"copper", {120e9, 0.34, 8960}},
    {"tungsten_carbide", {600e9, 0.22, 15600}},
    {"fused_silica", {72e9, 0.17, 2200}},
    {"sapphire", {400e9, 0.27, 3980}},
    {"pmma", {3.1e9, 0.37, 1180}},
    {"polystyrene", {3.3e9, 0.34, 1050}},
    {"cork", {20e6, 0.01, 200}},
    {"auxetic", {100e6, -0.5, 500}},
}};
const std::array<std::string, 6> built_in{"aluminium", "pyrex",           "vitreous_carbon",
                                          "acrylic",   "silicone_rubber", "steel"};

constexpr double longest_s = 2e-3;  // longest duration

double rounded(double value, double digits = 3) {
    if (value == 0) {
        return 0;
    }
    const double unit = std::pow(10, std::floor(std::log10(value)) + 1 - digits);
    // a power of ten below one is not exact; dividing by its inverse gives the same number as reading the digits
    return unit < 1 ? std::round(value / unit) / std::round(1 / unit) : std::round(value / unit) * unit;
}

double size(Draw& draw, double least, double most) {
    return rounded(draw.magnitude(least, most));
}

std::string any_solid(Draw& draw, Scene& scene) {
    if (!draw.one_in(4)) {
        return draw.any(built_in);
    }
    const auto solid = draw.any(own_solids);
    scene.materials[solid.first] = solid.second;
    return solid.first;
}

std::string sphere_material(Draw& draw, Scene& scene, Kind kind) {
    static const std::array<std::string, 3> usual{"aluminium", "aluminium", "steel"};
    const std::string often = draw.any(usual);
    return kind != Kind::near_paper && draw.one_in(3) ? any_solid(draw, scene) : often;
}

void draw_chain(Draw& draw, Scene& scene, Kind kind) {
    Spheres& chain = scene.chain;
    chain.material = sphere_material(draw, scene, kind);
    const bool undamped = kind != Kind::near_paper && draw.one_in(3);
    const bool loose = draw.one_in(3);
    if (kind == Kind::near_paper) {
        chain.spheres = draw.whole(1, 14);
        chain.diameter_m = rounded(draw.between(0.5e-3, 1.5e-3));
        chain.damping_kg_per_s = size(draw, 0.05, 0.7);
        chain.preload_n = size(draw, 0.01, 1);
    } else {
        const bool is_long = kind == Kind::long_chain;
        chain.spheres = is_long ? draw.whole(60, 200) : draw.whole(1, draw.one_in(3) ? 40 : 16);
        chain.diameter_m = size(draw, 0.3e-3, is_long ? 1.5e-3 : 4.3e-3);
        // with more damping the wave does not reach the end of a long chain
        const double damping = is_long ? size(draw, 0.005, 0.01) : size(draw, 0.005, 0.9);
        chain.damping_kg_per_s = undamped ? 0 : damping;
        chain.preload_n = loose ? 0 : size(draw, 1e-4, 5);
    }
    chain.tension = draw.one_in(6) ? Tension::clamped : Tension::allowed;
}

void draw_drive(Draw& draw, Scene& scene, Kind kind) {
    Drive& drive = scene.drive;
    const std::string other = any_solid(draw, scene);
    drive.material = draw.one_in(6) ? other : "steel";
    drive.amplitude_m = size(draw, 10e-9, 10e-6);
    drive.envelope = draw.any(choices<Envelope>);
    if (drive.envelope == Envelope::tukey) {
        drive.taper = rounded(draw.between(0.05, 1), 2);
    }
    if (kind == Kind::long_chain) {
        drive.frequency_hz = size(draw, 40e3, 200e3);
        drive.cycles = static_cast<double>(draw.whole(1, 5));
        return;
    }
    const bool near_paper = kind == Kind::near_paper;
    drive.frequency_hz = near_paper ? size(draw, 40e3, 100e3) : size(draw, 20e3, 400e3);
    const auto whole = static_cast<double>(draw.whole(1, 25));
    drive.cycles = near_paper || !draw.one_in(3) ? whole : rounded(draw.between(1, 25));
    const double most_hz = std::min(0.95 * drive.frequency_hz / drive.cycles, 20e3);
    if (draw.one_in(5) && most_hz > 500) {
        drive.repetition_hz = size(draw, 500, most_hz);
    }
}

void draw_end(Draw& draw, Scene& scene) {
    End& end = scene.end;
    end.kind = draw.one_in(4) ? draw.any(std::array{EndKind::wall, EndKind::free}) : EndKind::plate;
    if (end.kind != EndKind::free) {
        end.material = any_solid(draw, scene);
    }
    if (end.kind != EndKind::plate) {
        return;
    }
    end.radius_m = draw.one_in(2) ? 5e-3 : rounded(draw.between(2e-3, 10e-3), 2);
    end.thickness_m = size(draw, 0.1e-3, 3e-3);
    if (draw.one_in(4)) {
        end.stiffness_n_per_m = size(draw, 1e3, 1e7);
    }
    end.preload = draw.one_in(5) ? PlatePreload::as_printed : PlatePreload::balanced;
    if (draw.one_in(6)) {
        scene.materials["oil"] = Fluid{870, 1440};
        scene.medium.material = "oil";
    }
}

void draw_layers(Draw& draw, Scene& scene) {
    End& end = scene.end;
    const std::int64_t layers = draw.whole(2, 3);
    for (std::int64_t i = 0; i < layers; ++i) {
        end.materials.push_back(any_solid(draw, scene));
        end.thicknesses_m.push_back(size(draw, 0.05e-3, 1e-3));
        if (draw.one_in(2) && end.loss_factors.size() == static_cast<std::size_t>(i)) {
            end.loss_factors.push_back(size(draw, 1e-3, 0.1));
        }
    }
    end.loss_factors.resize(end.loss_factors.empty() ? 0 : end.materials.size(), 0.01);
}

void draw_modal_plate(Draw& draw, Scene& scene) {
    End& end = scene.end;
    end = End{};
    end.kind = EndKind::plate;
    end.model = PlateModel::modal;
    end.material = any_solid(draw, scene);
    end.radius_m = draw.one_in(3) ? 5e-3 : rounded(draw.between(2e-3, 10e-3), 2);
    end.thickness_m = size(draw, 0.1e-3, 3e-3);
    end.theory = draw.any(choices<PlateTheory>);
    end.modes = draw.whole(1, 6);
    end.loss_factor = size(draw, 1e-3, 0.1);
    if (draw.one_in(3)) {
        draw_layers(draw, scene);
    }
    scene.medium.load = draw.one_in(3) ? draw.any(choices<FluidLoad>) : FluidLoad::radiation;
    if (draw.one_in(4)) {
        scene.materials["oil"] = Fluid{870, 1440};
        scene.medium.material = "oil";
    }
    scene.output.hydrophone_m = size(draw, 0.1e-3, 300e-3);
    if (draw.one_in(2)) {
        for (std::int64_t i = draw.whole(1, 4); i > 0; --i) {
            scene.output.points_m.push_back({draw.zero_or(size(draw, 0.1e-3, 50e-3)),
                                             draw.zero_or(-size(draw, 0.1e-3, 50e-3)),
                                             draw.zero_or(size(draw, 0.1e-3, 100e-3))});
        }
    }
}

/// Draws different spheres, a start and a support, and a sweep.
void draw_row(Draw& draw, Scene& scene) {
    Spheres& chain = scene.chain;
    if (draw.one_in(4)) {
        scene.drive.sweep_to_hz = rounded(scene.drive.frequency_hz * draw.between(0.5, 2));
    }
    if (draw.one_in(2)) {
        for (std::int64_t i = draw.whole(2, 4); i > 0; --i) {
            chain.materials.push_back(any_solid(draw, scene));
        }
    }
    if (draw.one_in(2)) {
        for (std::int64_t i = draw.whole(2, 5); i > 0; --i) {
            chain.diameters_m.push_back(rounded(chain.diameter_m * draw.magnitude(0.4, 2)));
        }
    }
    const double steepest = std::min(0.08, 1.5 / static_cast<double>(chain.spheres));
    chain.taper = draw.one_in(3) ? rounded(draw.between(-steepest, steepest), 2) : 0;
    chain.gravity_m_per_s2 = draw.one_in(3) ? draw.any(std::array{9.81, 1000.0, 1e4}) : 0;
    if (draw.one_in(3)) {
        chain.holder_time_s = size(draw, 10e-6, 10e-3);
    }
    if (draw.one_in(2)) {
        chain.impact_velocity_m_per_s = size(draw, 1e-3, 3);
        chain.impact_spheres = draw.whole(1, std::min<std::int64_t>(3, chain.spheres));
        scene.drive.kind = draw.one_in(4) ? DriveKind::tone : DriveKind::none;
        scene.drive.repetition_hz = 0;
    }
    if (draw.one_in(3)) {
        chain.damping_law = draw.any(std::array{DampingLaw::kuwabara_kono, DampingLaw::tsuji});
        chain.damping_time_s = size(draw, 1e-9, 1e-6);
        chain.damping_alpha = size(draw, 0.01, 0.5);
    }
}

/// Draws a record of the tone's motion, with noise, in place of the tone, and a resonant horn.
void draw_horn(Draw& draw, Scene& scene) {
    Drive& drive = scene.drive;
    if (drive.kind == DriveKind::none) {
        return;
    }
    if (draw.one_in(3)) {
        const double rate = size(draw, 15, 200) * drive.frequency_hz;
        const bool velocity = draw.one_in(2);
        const double noise = draw.one_in(2) ? 0 : draw.magnitude(1e-7, 1e-4);
        const auto tone = make_horn(drive, 1 / rate);
        const double rest_s = draw.between(0, 3) / drive.frequency_hz;
        const auto count =
            static_cast<std::int64_t>(std::ceil((drive.cycles / drive.frequency_hz + rest_s) * rate));
        const double largest = velocity ? largest_velocity(drive) : drive.amplitude_m;
        for (std::int64_t i = 0; i < count; ++i) {
            const HornMotion now = tone->at(i, 0);
            drive.samples.push_back((velocity ? now.v : now.x) + noise * largest * draw.between(-1, 1));
        }
        drive.kind = DriveKind::file;
        drive.quantity = velocity ? DriveQuantity::velocity : DriveQuantity::displacement;
        drive.sample_rate_hz = rate;
        drive.sweep_to_hz.reset();
    }
    if (draw.one_in(3)) {
        drive.horn = HornModel::resonator;
        drive.horn_frequency_hz = rounded(drive.frequency_hz * draw.between(0.7, 1.4));
        drive.horn_quality = size(draw, 1, 300);
        drive.horn_mass_kg = draw.zero_or(size(draw, 1e-6, 1e-2));
    }
}

/// Returns the rough travel time of a wave to the end [s]. Without preload the wave slows down after its first impact.
double travel_s(const Scene& scene) {
    const Chain chain(scene);
    const Eigen::ArrayXd overlaps =
        scene.chain.preload_n > 0 ? chain.static_overlap : expected_overlaps(chain, scene.drive);
    const auto contact = std::min<Eigen::Index>(1, chain.spheres() - 1);
    const double tangent = 1.5 * chain.stiffness[contact] * std::sqrt(overlaps[contact]);
    const double slower = scene.chain.preload_n > 0 ? 1 : 2;
    return slower * static_cast<double>(chain.spheres()) / std::sqrt(tangent * chain.inv_mass[0]);
}

/// Returns a duration that covers the bursts, the wave's arrival and some ringing.
double duration_s(const Scene& scene, Kind kind) {
    const Drive& drive = scene.drive;
    const double burst = drive.cycles / drive.frequency_hz;
    const double travel = travel_s(scene);
    if (kind == Kind::long_chain) {
        return std::max(100e-6, 1.2 * (burst + travel));
    }
    const double periods = drive.repetition_hz > 0 ? 2.2 / drive.repetition_hz : 0;
    return std::min(longest_s, std::max({500e-6, 2 * burst + travel, periods}));
}

/// Discs in a square, one or two diameters apart, with drives and chains that differ in part.
void draw_elements(Draw& draw, Scene& scene) {
    Array& array = scene.array;
    const std::int64_t wanted = draw.one_in(4) ? draw.whole(8, 19) : draw.whole(2, 7);
    const double a = scene.end.radius_m;
    const double side = a * 2.2 * (1 + std::sqrt(static_cast<double>(wanted)));
    for (int tries = 0; std::ssize(array.x_m) < wanted && tries < 1000; ++tries) {
        const double x = rounded(draw.between(0, side), 4);
        const double y = rounded(draw.between(0, side), 4);
        bool free = true;
        for (std::size_t i = 0; i < array.x_m.size(); ++i) {
            free = free && std::hypot(array.x_m[i] - x, array.y_m[i] - y) >= 2 * a;
        }
        if (free) {
            array.x_m.push_back(x);
            array.y_m.push_back(y);
        }
    }
    const bool focused = draw.one_in(2);
    if (focused) {
        array.focus_m = {rounded(draw.between(0, side)), rounded(draw.between(0, side)),
                         size(draw, 5e-3, 80e-3)};
    }
    const bool by_preload = draw.one_in(3);
    for (std::size_t i = 0; i < array.x_m.size(); ++i) {
        if (!focused) {
            array.delays_s.push_back(rounded(draw.between(0, 6e-6)));
        }
        if (by_preload) {
            array.preloads_n.push_back(rounded(scene.chain.preload_n * draw.between(0.5, 2)));
        }
    }
    array.coupling = draw.one_in(4) ? Coupling::none : Coupling::fluid;
    scene.output.points_m = {
        {side / 2, side / 2, size(draw, 5e-3, 60e-3)},
        {rounded(draw.between(0, side)), rounded(draw.between(0, side)), size(draw, 2e-3, 60e-3)}};
}

/// Removes unused materials.
void drop_unused(Scene& scene) {
    std::erase_if(scene.materials, [&](const auto& own) {
        return own.first != scene.drive.material && own.first != scene.chain.material &&
               std::ranges::count(scene.chain.materials, own.first) == 0 && own.first != scene.end.material &&
               own.first != scene.medium.material && std::ranges::count(scene.end.materials, own.first) == 0;
    });
}

/// Draws a scene. Returns nullopt if it is not valid, or if no wave would arrive within its duration.
std::optional<DesignScene> drawn(Draw draw) {
    const bool near_paper = draw.one_in(7);
    const Kind other = draw.one_in(5) ? Kind::long_chain : Kind::short_chain;
    const Kind kind = near_paper ? Kind::near_paper : other;
    DesignScene design{Scene{}, near_paper};
    Scene& scene = design.scene;
    draw_drive(draw, scene, kind);
    draw_chain(draw, scene, kind);
    draw_end(draw, scene);
    drop_unused(scene);
    if (draw.one_in(8)) {
        scene.output.sample_rate_hz = draw.any(std::array{1e6, 2e6, 25e6});
    }
    if (!validate(scene).empty()) {
        return std::nullopt;
    }
    scene.output.duration_s = std::round(1e7 * duration_s(scene, kind)) / 1e7;
    return scene.output.duration_s <= longest_s ? std::optional(design) : std::nullopt;
}

}  // namespace

DesignScene design_scene(std::uint64_t seed, std::uint64_t index) {
    const Draw draw = Draw(seed).branch(index);
    for (std::uint64_t attempt = 0;; ++attempt) {
        if (auto design = drawn(draw.branch(attempt))) {
            return *std::move(design);
        }
    }
}

DesignScene wet_design_scene(std::uint64_t seed, std::uint64_t index) {
    const Draw drawing = Draw(seed + 1'000'000).branch(index);
    for (std::uint64_t attempt = 0;; ++attempt) {
        Draw draw = drawing.branch(attempt);
        const Kind kind = draw.one_in(4) ? Kind::near_paper : Kind::short_chain;
        DesignScene design{Scene{}, kind == Kind::near_paper};
        Scene& scene = design.scene;
        draw_drive(draw, scene, kind);
        scene.drive.repetition_hz = 0;
        draw_chain(draw, scene, kind);
        draw_modal_plate(draw, scene);
        drop_unused(scene);
        if (!validate(scene).empty() || !plate_faults(scene).empty()) {
            continue;
        }
        scene.output.duration_s = std::round(1e7 * (duration_s(scene, kind) + 20e-6)) / 1e7;
        if (scene.output.duration_s <= 1e-3) {
            return design;
        }
    }
}

DesignScene mixed_design_scene(std::uint64_t seed, std::uint64_t index) {
    const Draw drawing = Draw(seed + 2'000'000).branch(index);
    for (std::uint64_t attempt = 0;; ++attempt) {
        Draw draw = drawing.branch(attempt);
        const Kind kind = draw.one_in(8) ? Kind::long_chain : Kind::short_chain;
        DesignScene design{Scene{}, false};
        Scene& scene = design.scene;
        draw_drive(draw, scene, kind);
        draw_chain(draw, scene, kind);
        draw_end(draw, scene);
        draw_row(draw, scene);
        draw_horn(draw, scene);
        drop_unused(scene);
        if (!validate(scene).empty() || !model_faults(scene).empty()) {
            continue;
        }
        scene.output.duration_s = std::round(1e7 * duration_s(scene, kind)) / 1e7;
        if (scene.output.duration_s <= longest_s) {
            return design;
        }
    }
}

DesignScene array_design_scene(std::uint64_t seed, std::uint64_t index) {
    const Draw drawing = Draw(seed + 3'000'000).branch(index);
    for (std::uint64_t attempt = 0;; ++attempt) {
        Draw draw = drawing.branch(attempt);
        DesignScene design = wet_design_scene(draw.whole(1, 1'000'000'000), 0);
        Scene& scene = design.scene;
        scene.medium.load = FluidLoad::radiation;
        scene.output.duration_s = std::min(scene.output.duration_s, 400e-6);
        draw_elements(draw, scene);
        bool possible = validate(scene).empty();
        for (std::size_t i = 0; possible && i < scene.array.x_m.size(); ++i) {
            possible = model_faults(element_scene(scene, i)).empty();
        }
        if (possible) {
            return design;
        }
    }
}

std::string description(const Scene& scene) {
    const Drive& drive = scene.drive;
    const Spheres& chain = scene.chain;
    const End& end = scene.end;
    std::array<char, 512> text{};
    std::snprintf(text.data(), text.size(), "%lld %s %.3g mm, F0 %.3g, l %.3g, %.3g kHz x%.3g %s %.3g um",
                  static_cast<long long>(chain.spheres), chain.material.c_str(), 1e3 * chain.diameter_m,
                  chain.preload_n, chain.damping_kg_per_s, 1e-3 * drive.frequency_hz, drive.cycles,
                  std::string(word(drive.envelope)).c_str(), 1e6 * drive.amplitude_m);
    std::string all = text.data();
    if (drive.kind == DriveKind::file) {
        std::snprintf(text.data(), text.size(), " as a record of %zu samples at %.3g Hz",
                      drive.samples.size(), drive.sample_rate_hz.value_or(0));
        all += text.data();
    }
    if (drive.horn == HornModel::resonator) {
        std::snprintf(text.data(), text.size(), " by a horn of %.3g kHz, Q %.3g, %.3g g",
                      1e-3 * drive.horn_frequency_hz.value_or(drive.frequency_hz), drive.horn_quality,
                      1e3 * drive.horn_mass_kg);
        all += text.data();
    }
    if (drive.repetition_hz > 0) {
        std::snprintf(text.data(), text.size(), " repeated at %.3g Hz", drive.repetition_hz);
        all += text.data();
    }
    all += ", " + std::string(word(end.kind)) + (end.kind == EndKind::free ? "" : " " + end.material);
    all += end.kind == EndKind::plate && end.preload == PlatePreload::as_printed ? ", as_printed" : "";
    all += chain.tension == Tension::clamped ? ", clamped" : "";
    all += chain.damping_law != DampingLaw::dashpot ? ", " + std::string(word(chain.damping_law)) : "";
    if (!chain.materials.empty() || !chain.diameters_m.empty() || chain.taper != 0) {
        std::snprintf(text.data(), text.size(), ", %zu materials, %zu diameters, taper %.2g",
                      chain.materials.size(), chain.diameters_m.size(), chain.taper);
        all += text.data();
    }
    if (chain.impact_velocity_m_per_s != 0) {
        std::snprintf(text.data(), text.size(), ", %lld strike with %.3g m/s%s",
                      static_cast<long long>(chain.impact_spheres), chain.impact_velocity_m_per_s,
                      scene.drive.kind == DriveKind::none ? ", no horn" : "");
        all += text.data();
    }
    if (chain.gravity_m_per_s2 != 0 || chain.holder_time_s) {
        std::snprintf(text.data(), text.size(), ", g %.3g, holder %.3g s", chain.gravity_m_per_s2,
                      chain.holder_time_s.value_or(0));
        all += text.data();
    }
    if (end.kind == EndKind::plate && end.model == PlateModel::modal) {
        std::snprintf(text.data(), text.size(),
                      " %s, a %.3g mm, %zu layers, %lld modes, %s in %s, z %.3g mm, %zu points",
                      std::string(word(end.theory)).c_str(), 1e3 * end.radius_m,
                      std::max<std::size_t>(1, end.materials.size()), static_cast<long long>(end.modes),
                      std::string(word(scene.medium.load)).c_str(), scene.medium.material.c_str(),
                      1e3 * scene.output.hydrophone_m, scene.output.points_m.size());
        all += text.data();
    }
    std::snprintf(text.data(), text.size(), ", %.4g us", 1e6 * scene.output.duration_s);
    return all + text.data();
}

}  // namespace hertzline::test
