// Converts a scene to the plain numbers of the peers.

#include "bench/peers/problem.hpp"

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "core/model/chain.hpp"

namespace hertzline::bench {

namespace {

constexpr double time_unit = 1e-6;  // [s]

std::vector<double> scaled(const Eigen::ArrayXd& values, std::size_t count, double factor) {
    std::vector<double> result(count, 0.0);
    for (std::size_t i = 0; i < count && i < static_cast<std::size_t>(values.size()); ++i) {
        result[i] = values[static_cast<Eigen::Index>(i)] * factor;
    }
    return result;
}

}  // namespace

Problem problem(const Scene& scene, std::size_t samples) {
    if (scene.drive.envelope != Envelope::hann || scene.drive.repetition_hz > 0 ||
        scene.chain.tension != Tension::allowed) {
        throw std::invalid_argument("the peers simulate one hann burst with the contact law as printed");
    }
    const Chain chain(scene);
    const double length = scene.drive.amplitude_m;
    const double force = length / (time_unit * time_unit);  // with masses in kg
    const bool plate = chain.end.has_plate;
    const auto spheres = static_cast<std::size_t>(chain.spheres());
    const std::size_t bodies = spheres + (plate ? 1 : 0);
    Problem p{
        .bodies = bodies,
        .last_sphere = spheres - 1,
        .plate = plate,
        .contacts = static_cast<std::size_t>((chain.stiffness > 0).count()),
        .stiffness = scaled(chain.stiffness, bodies + 1, length * std::sqrt(length) / force),
        .static_overlap = scaled(chain.static_overlap, bodies + 1, 1 / length),
        .damping = scaled(chain.damping, bodies + 1, length / time_unit / force),
        .inv_mass = scaled(chain.inv_mass, bodies, 1),
        .spring = scaled(chain.spring, bodies, length / force),
        .load = std::vector<double>(bodies, 0.0),
        .carrier = 2 * std::numbers::pi * scene.drive.frequency_hz * time_unit,
        .envelope = 2 * std::numbers::pi * scene.drive.frequency_hz / scene.drive.cycles * time_unit,
        .burst = scene.drive.cycles / scene.drive.frequency_hz / time_unit,
        .sample_period = 1 / scene.output.sample_rate_hz / time_unit,
        .samples = samples,
        .velocity_unit = length / time_unit,
        .transmission = chain.end.transmission,
    };
    if (chain.end.loaded == EndLoad::end || chain.end.loaded == EndLoad::last_sphere) {
        p.load.back() = chain.preload_n / force;  // the plate's, or the last sphere's at a free end
    }
    return p;
}

Trace::Trace(const Problem& of)
    : v_last(of.samples), v_plate(of.plate ? of.samples : 0), v_out(of.plate ? of.samples : 0) {}

}  // namespace hertzline::bench
