#pragma once
// Pulses in a chain without preload and damping: making and measuring them.

#include <array>
#include <cmath>
#include <optional>

#include <gtest/gtest.h>

#include "core/model/contact_law.hpp"
#include "tests/support/bare_chain.hpp"
#include "tests/support/solitary_wave.hpp"

namespace hertzline::test {

inline constexpr double diameter = 1e-3;       // [m]
inline constexpr double pulse_step = 10e-9;    // [s]; a pulse takes some 5 us to pass a contact
inline constexpr double far_from_horn = 1e-5;  // distance of the spheres [m]

/// Makes a line of spheres that just touch, with nothing at either end.
inline BareChain sonic_vacuum(Integrator integrator, std::int64_t spheres) {
    Scene scene = with_step(Scene{}, integrator, pulse_step);
    scene.end.kind = EndKind::free;
    scene.chain.spheres = spheres;
    scene.chain.diameter_m = diameter;
    scene.chain.preload_n = 0;
    scene.chain.damping_kg_per_s = 0;
    BareChain chain(scene);
    chain.state.x.setConstant(far_from_horn);
    return chain;
}

/// Makes the same line, with its first sphere thrown at the others.
inline BareChain struck(Integrator integrator, std::int64_t spheres, double speed) {
    BareChain chain = sonic_vacuum(integrator, spheres);
    chain.state.v[0] = speed;
    return chain;
}

/// The crest of a pulse as it passes a contact.
struct Crest {
    double overlap = 0;  ///< [m]
    double time_s = 0;
};

/// Returns the vertex of the parabola through the last three overlaps, if the middle one is a crest. Remainders of a
/// launch or a collision do not count.
inline std::optional<Crest> crest_of(std::array<double, 3> last, double time_s, double interval_s) {
    constexpr double noticeable = 1e-9;  // [m]
    if (last[1] < noticeable || last[1] < last[0] || last[1] <= last[2]) {
        return std::nullopt;
    }
    const double slope = (last[2] - last[0]) / 2;
    const double bend = last[2] - 2 * last[1] + last[0];
    return Crest{last[1] - slope * slope / (2 * bend), time_s - interval_s * (1 + slope / bend)};
}

/// Takes steps until a crest has passed the contact.
inline Crest crest_at(BareChain& chain, Eigen::Index contact) {
    constexpr int stride = 4;
    std::array<double, 3> last{};
    while (chain.time_s() < 1e-3) {
        chain.advance(stride);
        last = {last[1], last[2], chain.overlap(contact)};
        if (const auto crest = crest_of(last, chain.time_s(), stride * pulse_step)) {
            return *crest;
        }
    }
    ADD_FAILURE() << "no pulse passes contact " << contact;
    return {};
}

/// A pulse between two contacts.
struct Pulse {
    double peak_overlap;  ///< [m]
    double peak_force;    ///< [N]
    double speed;         ///< [m/s]
};
inline Pulse pulse_between(BareChain& chain, Eigen::Index near, Eigen::Index far) {
    const Crest first = crest_at(chain, near);
    const Crest second = crest_at(chain, far);
    return {second.overlap, elastic_force(chain.chain.stiffness[far], second.overlap),
            static_cast<double>(far - near) * diameter / (second.time_s - first.time_s)};
}

/// Units of the solitary wave's speed and particle velocities in this chain.
struct WaveUnits {
    double time_s;
    double speed_m_per_s;     ///< a diameter a unit of time
    double velocity_m_per_s;  ///< the largest overlap a unit of time
};
inline WaveUnits units_of(const Chain& chain, double peak_overlap) {
    const double time = 1 / std::sqrt(chain.stiffness[1] * chain.inv_mass[1] * std::sqrt(peak_overlap));
    return {time, diameter / time, peak_overlap / time};
}

/// Puts a solitary wave into a chain, with its crest at a contact.
inline void launch(BareChain& chain, Eigen::Index crest, double peak_overlap) {
    const WaveUnits units = units_of(chain.chain, peak_overlap);
    double ahead = 0;  // the distance by which the wave will still push the sphere [m]
    for (Eigen::Index b = chain.chain.spheres() - 1; b >= 0; --b) {
        const auto x = static_cast<double>(b - crest);
        chain.state.x[b] += ahead;
        chain.state.v[b] += units.velocity_m_per_s * solitary_wave().velocity(x);
        ahead += peak_overlap * solitary_wave().overlap(x);
    }
}

}  // namespace hertzline::test
