#pragma once
// The pressure at a point as a function of the last contact's force, and what it takes to compute it from sample to sample.
//
// Time is cut into equal intervals. Of the force over each its moments are kept, integrals with the polynomials of Legendre as weights,
// and at the interval's end the states that it drives. No sound is heard for longer than 2 a/c from its first to its last: the pressure
// is a sum over the moments of as many intervals, and over the states before them (docs/model.md, section 10).

#include <array>
#include <cstddef>
#include <vector>

#include "core/plate/plate_response.hpp"
#include "core/plate/point_sound.hpp"

namespace hertzline {

/// Moments of a force over an interval [N s].
inline constexpr std::size_t force_moments = 6;
/// Room for them.
inline constexpr std::size_t moment_stride = 8;

/// Length of an interval over which these moments give states and pressure to about the accuracy of the response [s].
/// @param sound_s time from the first to the last sound at the point
double longest_interval_s(const PlateResponse& response, double sound_s) noexcept;

/// States of a response as rows of numbers: real parts, then imaginary ones, each of size() numbers.
class ForcedStates {
public:
    ForcedStates(const PlateResponse& response, double interval_s);

    std::size_t size() const noexcept { return size_; }  ///< pairs, padded to a multiple of 8
    /// States at the end of an interval: the ones at its start times this...
    const double* turn() const noexcept { return columns_.data(); }
    /// ... and each moment times this.
    const double* of_moment(std::size_t q) const noexcept { return columns_.data() + 2 * (1 + q) * size_; }

private:
    std::size_t size_;
    std::vector<double> columns_;
};

/// Nodes of the integrals over a stretch of time in which a kernel is smooth.
inline constexpr std::size_t stretch_nodes = 24;

/// The answer to a jump of the force, less the part of it that the moments have, while the kernel is smooth.
struct JumpRest {
    double from, to;             ///< ages after the first sound [intervals]
    std::vector<double> series;  ///< Chebyshev's coefficients over the smooth step of the age [Pa/N]
};

/// The pressure at one point: a sum of products with moments and states. The first sound sets in at once. So the newest moments are those
/// of a part of an interval, up to the moment from which the first sound arrives.
struct ForceKernel {
    /// @param share of an interval that the newest part covers, above 0 and at most 1
    ForceKernel(const PlateResponse& response, const SoundSum& sound, double interval_s, double share);

    std::array<double, moment_stride> newest{};  ///< factors of that part's moments [Pa/(N s)]
    std::size_t intervals = 0;                   ///< before it, whose moments count; even
    std::vector<double> moments;  ///< factors of their moments [Pa/(N s)], the oldest interval first
    std::vector<double> states;   ///< factors of the states before these intervals, as ForcedStates has them
    /// Where moments are not enough for a force that jumps, by ages: near the first and last sounds, where kernels begin and end like square roots.
    std::vector<JumpRest> steep;

    /// The part of the pressure after a jump of the force that the moments lack [Pa/N]. @param age from the first sound on [intervals]
    double rest_of_jump(double age) const noexcept;
};

}  // namespace hertzline
