#include "core/integrators/stability.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/model/contact_law.hpp"
#include "core/model/drive.hpp"

namespace hertzline {

namespace {

/// Gershgorin's bound on the eigenvalues of M^-1/2 K M^-1/2 for a chain of couplings k(c) [N/m or kg/s]; NaN stays NaN.
template <class Coupling>
double spectral_bound(const Chain& chain, Eigen::Index bodies, Coupling coupling,
                      double spring_weight) noexcept {
    const Eigen::Index last = bodies - 1;
    double left = coupling(0);
    double left_mobility = std::sqrt(chain.horn_inv_mass);  // 0 where the horn's motion is prescribed
    double root = std::sqrt(chain.inv_mass[0]);
    double bound = spring_weight * chain.horn_square;
    if (left_mobility > 0) {
        bound += left_mobility * (left * left_mobility + left * root);
    }
    for (Eigen::Index b = 0; b <= last; ++b) {
        const double right = b < last ? coupling(b + 1) : 0;
        const double right_mobility = b < last ? std::sqrt(chain.inv_mass[b + 1]) : 0;
        const double spring = spring_weight * chain.spring[b];
        const double row =
            root * ((left + right + spring) * root + left * left_mobility + right * right_mobility);
        bound = row <= bound || std::isnan(bound) ? bound : row;  // a NaN wins, and stays
        left = right;
        left_mobility = root;
        root = right_mobility;
    }
    return bound;
}

/// @param overlap of a contact [m]
template <class Overlap>
double squared_frequency(const Chain& chain, Eigen::Index bodies, Overlap overlap) noexcept {
    return spectral_bound(
        chain, bodies,
        [&](Eigen::Index c) { return 1.5 * chain.stiffness[c] * std::sqrt(std::max(overlap(c), 0.0)); }, 1);
}

/// @param overlap of a contact [m]
template <class Overlap>
double stable_step(const Chain& chain, Eigen::Index bodies, Overlap overlap, Integrator integrator) noexcept {
    const double omega_squared = squared_frequency(chain, bodies, overlap);
    const double gamma =
        spectral_bound(
            chain, bodies,
            [&](Eigen::Index c) { return chain.damping[c] * damping_power(chain.damping_law, overlap(c)); },
            0) +
        chain.holder_rate;
    const Method& bounds = method(integrator);
    const double a = omega_squared / (bounds.oscillation_bound * bounds.oscillation_bound);
    const double b = gamma / bounds.decay_bound;
    if (std::isnan(a) || std::isnan(b)) {
        return 0;
    }
    if (a == 0 && b == 0) {
        return std::numeric_limits<double>::infinity();
    }
    return 2 / (b + std::sqrt(b * b + 4 * a));  // root of a h^2 + b h = 1
}

}  // namespace

Eigen::ArrayXd expected_overlaps(const Chain& chain, const Drive& drive) {
    // an impact: Johnson 1985, eq. 11.2: (15 m u^2 / 16 k')^(2/5), here with k = 4/3 k', and m twice the reduced mass
    const double u = std::max(largest_velocity(drive), std::abs(chain.impact_velocity));
    Eigen::ArrayXd overlaps = chain.static_overlap;
    const Eigen::Index last = chain.spheres() - 1;
    for (Eigen::Index c = 0; c < chain.bodies(); ++c) {
        if (chain.stiffness[c] > 0) {
            const double left = chain.inv_mass[std::max<Eigen::Index>(c - 1, 0)];
            const double right = chain.inv_mass[std::min(c, last)];
            // spheres lighter than the first become faster, by its energy at most
            const double faster = std::max(1.0, std::max(left, right) / chain.inv_mass[0]);
            overlaps[c] += std::pow(1.25 * u * u * faster / ((left + right) / 2 * chain.stiffness[c]), 0.4);
        }
    }
    return overlaps;
}

double fastest_frequency(const Chain& chain, const Eigen::Ref<const Eigen::ArrayXd>& overlaps) noexcept {
    return std::sqrt(squared_frequency(chain, overlaps.size(), [&](Eigen::Index c) { return overlaps[c]; }));
}

double fastest_decay(const Chain& chain, const Eigen::Ref<const Eigen::ArrayXd>& overlaps) noexcept {
    double fastest = 0;
    for (Eigen::Index c = 0; c < chain.bodies(); ++c) {
        const double damping = chain.damping[c] * damping_power(chain.damping_law, overlaps[c]);
        fastest = std::max(fastest, damping * chain.mobility(c));
    }
    return 2 * fastest + chain.holder_rate;
}

double largest_stable_step(const Chain& chain, const Eigen::Ref<const Eigen::ArrayXd>& overlaps,
                           Integrator integrator) noexcept {
    return stable_step(
        chain, overlaps.size(), [&](Eigen::Index c) { return overlaps[c]; }, integrator);
}

double largest_stable_step(const Chain& chain, double overlap, Integrator integrator) noexcept {
    return stable_step(
        chain, chain.bodies(), [&](Eigen::Index) { return overlap; }, integrator);
}

}  // namespace hertzline
