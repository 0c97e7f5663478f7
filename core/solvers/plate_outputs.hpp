#pragma once
// What a modal plate sends out: the mean velocity of its face, and the pressure at the hydrophone.
//
// The pressure is p(t) = rho c v_centre(t - z/c) + rho int h'(s) q'(t - s) ds over the kernel's length, a sum over the modes
// (docs/model.md, section 10). Time is cut into intervals whose ends lie z/c before the samples. Over each of them the modes' velocities
// are integrated exactly, with the first polynomials of Legendre as weights; the kernel is expanded in the same polynomials.
// So the pressure does not hang on the sample rate. Each value waits in a ring until it arrives.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/integrators/plate_motion.hpp"
#include "core/integrators/series_piece.hpp"
#include "core/model/chain.hpp"
#include "core/solvers/end_taps.hpp"
#include "core/solvers/fixed_time.hpp"
#include "core/taps.hpp"

namespace hertzline {

/// Where a piece begins and ends [samples].
struct Stretch {
    FixedTime begin;
    FixedTime end;
};

/// A sum over the velocities of a plate's modes in a piece, as a polynomial in z.
struct SumOfModes {
    std::array<double, kernels::PlateMotion::most_terms> terms{};
    double at_once = 0;  ///< per velocity of the body when a force sets in
};
/// The sums that outputs are made of, for a piece.
struct PlateVelocities {
    SumOfModes centre, face;
    bool none = true;  ///< nothing moves
};

class PlateOutputs {
public:
    /// All outlive the object. @param plate null: there is none, and nothing is done @param taps all that may be wanted
    PlateOutputs(const Chain& chain, kernels::PlateMotion* plate, const kernels::SeriesPiece& piece,
                 double sample_period_s, TapSet taps);

    /// Back to sample 0: the plate at rest, and no sound on its way.
    void reset() noexcept;

    /// Puts down the samples that the motion has room for. @param piece the present one @param first number of the first sample
    void put(const EndMotion& motion, const kernels::SampleTimes& times, std::size_t count,
             const Stretch& piece, std::int64_t first) noexcept;

    /// The piece is done: the pressures that it sends are computed.
    void leave_piece(const Stretch& piece) noexcept;

    /// Bytes, roughly from above. @param delay of the pressure [samples]
    static double bytes(double delay) noexcept;

    static constexpr std::size_t moments = 4;  ///< polynomials across an interval

private:
    static constexpr std::size_t stride = kernels::PlateMotion::mode_stride;
    using Moments = std::array<double, moments * stride>;  // [polynomial][mode]
    void make_kernel(const PlateResponse& response, double sample_period_s);
    const PlateVelocities& velocities() noexcept;
    double velocity(const SumOfModes& sum, double z) const noexcept;
    void add_moments(double from, double to, double line) noexcept;
    double pressure(double centre) const noexcept;
    double place_of(std::int64_t line, const Stretch& piece) const noexcept;
    void send(double until, const Stretch& piece) noexcept;
    double& in_ring(std::int64_t sample) noexcept {
        return ring_[static_cast<std::size_t>(sample) % ring_.size()];
    }

    kernels::PlateMotion* plate_;
    kernels::SeriesKernels kernels_;
    const kernels::SeriesPiece& piece_;
    double centre_at_once_ = 0, face_at_once_ = 0;  ///< as SumOfModes has it
    double sample_period_s_;
    bool has_pressure_ = false;
    double rho_c_ = 0;
    FixedTime delay_;  ///< of the pressure [samples]
    std::int64_t intervals_per_sample_ = 1;
    std::vector<Moments> kernel_;                ///< by intervals, the earliest first
    std::vector<Moments> history_;               ///< a ring of as many intervals
    Moments open_{};                             ///< of the interval that is not over
    std::int64_t line_ = 0;                      ///< the end of that interval, counted in intervals
    double done_ = 0;                            ///< of the present piece [z]
    std::vector<double> ring_;                   ///< pressures by samples
    std::optional<PlateVelocities> velocities_;  ///< of the present piece, when they were needed
};

}  // namespace hertzline
