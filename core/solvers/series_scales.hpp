#pragma once
// What is small in a scene: by it series tell where a motion ends, and what need not be resolved.

#include "core/model/chain.hpp"
#include "core/scene/scene.hpp"

namespace hertzline {

/// Velocity of the order of those that the scene will show [m/s]. @param omega of the fastest oscillation [rad/s]
double velocity_scale(const Chain& chain, const Drive& drive, double omega) noexcept;

/// Overlap [m] whose forces change a velocity by less than the tolerance [m/s] in a step. Below it a
/// contact is taken as just touching, so that the tails of a wave in a chain without preload, which fall like
/// a double exponential, need no resolving. A chain at rest under its preload must not be taken so.
/// @param tolerance [m/s] @param step [s]
double negligible_overlap(const Chain& chain, double tolerance, double step) noexcept;

}  // namespace hertzline
