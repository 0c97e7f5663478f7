#pragma once
// How large a step may be before the integration blows up.

#include <Eigen/Core>

#include "core/model/chain.hpp"

namespace hertzline {

/// Largest stable step [s] of an integrator on a chain whose contacts are pressed to the given overlaps [m].
///
/// An integrator's bounds for oscillation and decay (integrator.hpp) are taken together, on the safe side:
/// (h omega / bound)^2 + h gamma / bound <= 1. omega and gamma are Gershgorin's bounds, exact for a long
/// uniform chain. NaN overlaps give 0. Fewer overlaps than contacts: the bound of the first bodies only.
double largest_stable_step(const Chain& chain, const Eigen::Ref<const Eigen::ArrayXd>& overlaps,
                           Integrator integrator) noexcept;

/// The same with all contacts pressed to one overlap [m].
double largest_stable_step(const Chain& chain, double overlap, Integrator integrator) noexcept;

/// Upper estimate of the overlaps [m] before anything was simulated: the static ones plus those of an impact at
/// the horn's largest velocity.
Eigen::ArrayXd expected_overlaps(const Chain& chain, const Drive& drive);

/// Frequency bound [rad/s] of the chain's fastest mode at those overlaps.
double fastest_frequency(const Chain& chain, const Eigen::Ref<const Eigen::ArrayXd>& overlaps) noexcept;

/// Rate [1/s] at which damping of two equal bodies' contact slows their approach, at most, at those overlaps.
double fastest_decay(const Chain& chain, const Eigen::Ref<const Eigen::ArrayXd>& overlaps) noexcept;

}  // namespace hertzline
