#include "tests/support/random_scene.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/integrators/stability.hpp"
#include "core/scene/scene_key.hpp"
#include "core/scene/scene_words.hpp"
#include "tests/support/draw.hpp"

namespace hertzline::test {

namespace {

/// Draws one of the built-in solids, or one of the scene's own.
std::string some_solid(Draw& draw, Scene& scene) {
    static const std::array<std::string, 6> built_in{"aluminium", "pyrex",           "vitreous_carbon",
                                                     "acrylic",   "silicone_rubber", "steel"};
    if (!draw.one_in(4)) {
        return draw.any(built_in);
    }
    const std::string name = "solid_" + std::to_string(scene.materials.size());
    scene.materials[name] =
        Solid{draw.magnitude(1e6, 1e12), draw.between(-0.5, 0.499), draw.magnitude(100, 2e4)};
    return name;
}

void draw_drive(Draw& draw, Scene& scene) {
    Drive& drive = scene.drive;
    drive.material = some_solid(draw, scene);
    drive.frequency_hz = draw.magnitude(1e3, 1e6);
    drive.cycles =
        draw.one_in(2) ? draw.magnitude(0.05, 30) : draw.any(std::array{0.25, 1.0, 3.0, 5.5, 25.0});
    drive.amplitude_m = draw.one_in(10) ? 0 : draw.magnitude(1e-12, 1e-4);
    drive.envelope = draw.any(choices<Envelope>);
    drive.taper = draw.any(std::array{0.0, 1e-3, 0.2, 0.7, 1.0});
    drive.repetition_hz = draw.zero_or(drive.frequency_hz / drive.cycles * draw.between(0.05, 1));
}

void draw_chain_and_end(Draw& draw, Scene& scene) {
    Spheres& chain = scene.chain;
    chain.material = some_solid(draw, scene);
    chain.spheres = draw.whole(1, 40);
    chain.diameter_m = draw.magnitude(0.1e-3, 10e-3);
    chain.damping_kg_per_s = draw.zero_or(draw.magnitude(1e-4, 1e2));
    chain.preload_n = draw.zero_or(draw.magnitude(1e-6, 1e2));
    chain.tension = draw.any(choices<Tension>);
    End& end = scene.end;
    end.kind = draw.any(choices<EndKind>);
    end.material = some_solid(draw, scene);
    end.radius_m = draw.magnitude(1e-3, 20e-3);
    end.thickness_m = draw.magnitude(0.05e-3, 10e-3);
    if (draw.one_in(2)) {
        end.stiffness_n_per_m = draw.one_in(8) ? 0 : draw.magnitude(1e2, 1e10);
    }
    end.preload = draw.any(choices<PlatePreload>);
}

/// Draws different spheres, a start and a support, for half of the scenes.
void draw_any_row(Draw& draw, Scene& scene) {
    Spheres& chain = scene.chain;
    for (std::int64_t i = draw.one_in(3) ? draw.whole(1, 5) : 0; i > 0; --i) {
        chain.materials.push_back(some_solid(draw, scene));
    }
    for (std::int64_t i = draw.one_in(3) ? draw.whole(1, 5) : 0; i > 0; --i) {
        chain.diameters_m.push_back(std::clamp(chain.diameter_m * draw.magnitude(0.3, 3), 1e-9, 10.0));
    }
    chain.taper = draw.one_in(2) ? 0 : draw.between(-0.1, 0.1);
    chain.gravity_m_per_s2 = draw.one_in(2) ? 0 : draw.magnitude(1e-3, 1e4);
    if (draw.one_in(2)) {
        chain.holder_time_s = draw.magnitude(1e-7, 1);
    }
    if (draw.one_in(2)) {
        chain.impact_velocity_m_per_s = draw.magnitude(1e-6, 10) * (draw.one_in(4) ? -1 : 1);
        chain.impact_spheres = draw.whole(1, chain.spheres);
    }
    if (draw.one_in(3)) {
        scene.drive.sweep_to_hz = scene.drive.frequency_hz * draw.magnitude(0.3, 3);
    }
    if (draw.one_in(3)) {
        scene.drive.kind = DriveKind::none;
        scene.drive.repetition_hz = 0;
    }
}

/// Sets some of a scene's numbers to the bounds of validate().
void draw_extremes(Draw& draw, Scene& scene) {
    for (const SceneKey& key : scene_keys()) {
        const bool given = key.kind == ValueKind::number && key.value(scene);
        const bool of_row =
            key.key == "impact_spheres" || key.key == "gravity_m_per_s2" || key.name == "chain.taper";
        const bool wanted = key.section() != "output" && !of_row && !key.is_list() &&
                            !(key.is_optional && key.section() == "numerics");
        if (given && wanted && draw.one_in(6)) {
            key.set(scene, draw.one_in(2) ? key.range.min : key.range.max);
        }
    }
    const double max_bursts = scene.drive.frequency_hz / scene.drive.cycles;
    scene.drive.repetition_hz = std::min(scene.drive.repetition_hz, max_bursts);
    if (scene.drive.repetition_hz > 0) {
        scene.drive.start_s = 0;  // a burst lies within its period
    }
}

/// Draws steps from much too short to beyond the stability limit, and samples on their grid and off it.
void draw_numerics(Draw& draw, Scene& scene) {
    if (!draw.one_in(16)) {
        scene.numerics.integrator = draw.any(choices<Integrator>);
    }
    const Chain chain(scene);
    const double stable = largest_stable_step(chain, expected_overlaps(chain, scene.drive),
                                              scene.numerics.integrator.value_or(Integrator::taylor8));
    const double longest = std::min({stable, 0.2 / scene.drive.frequency_hz, 1.0});
    const double step = std::clamp(longest * draw.magnitude(3e-3, 3), 1e-12, 1.0);
    if (draw.one_in(16) || !scene.numerics.integrator) {
        scene.numerics.accuracy = draw.magnitude(1e-9, 0.1);
    } else {
        scene.numerics.step_s = step;
    }
    const double steps_per_sample = draw.any(std::array{1.0, 4.0, 3.3, 0.7, 0.1, 20.0});
    scene.output.sample_rate_hz = std::min(1 / (step * steps_per_sample), 1e12);
    scene.output.duration_s = std::clamp(step * draw.magnitude(30, 3000), 1e-12, 1e6);
}

}  // namespace

Scene random_scene(std::uint64_t seed) {
    Draw draw(seed);
    Scene scene;
    draw_drive(draw, scene);
    draw_chain_and_end(draw, scene);
    if (draw.one_in(8)) {
        draw_extremes(draw, scene);
    }
    if (Draw apart(~seed); apart.one_in(2)) {
        draw_any_row(apart, scene);
    }
    draw_numerics(draw, scene);
    return scene;
}

}  // namespace hertzline::test
