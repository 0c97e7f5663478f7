#pragma once
// The outputs of a modal plate: the mean velocity of its face, and the pressure at the hydrophone.
//
// The pressure is p(t) = rho c v_centre(t - z/c) + rho int h'(s) q'(t - s) ds over the kernel's length, a sum over the modes
// (docs/model.md, section 10). Time is cut into intervals whose ends lie z/c before the samples. Over each of them the modes' velocities
// are integrated exactly, with the first polynomials of Legendre as weights; the kernel is expanded in the same polynomials.
// So the pressure does not depend on the sample rate. Each value waits in a ring until it arrives.

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/integrators/plate_motion.hpp"
#include "core/integrators/series_piece.hpp"
#include "core/model/chain.hpp"
#include "core/solvers/fixed_time.hpp"
#include "core/solvers/sampling/end_taps.hpp"
#include "hertzline/taps.hpp"

namespace hertzline {

/// Where a piece begins and ends [samples].
struct Stretch {
    FixedTime begin;
    FixedTime end;
};

class PlateOutputs {
public:
    /// All outlive the object. @param plate null: there is none, and nothing is done @param taps all that may be wanted
    PlateOutputs(const Chain& chain, kernels::PlateMotion* plate, const kernels::SeriesPiece& piece,
                 Integrator integrator, double sample_period_s, TapSet taps);

    /// Back to sample 0: the plate at rest, and no sound on its way.
    void reset() noexcept;

    /// Takes over the sound on its way, of a plate and taps that are equal to these. Allocates nothing.
    /// @param samples number there of sample 0 here
    void continue_from(const PlateOutputs& before, std::int64_t samples) noexcept;

    /// Puts down the samples that the motion has room for. @param piece the present one @param first number of the first sample
    void put(const EndMotion& motion, const kernels::SampleTimes& times, std::size_t count,
             const Stretch& piece, std::int64_t first) noexcept;

    /// The piece is done: the pressures that it sends are computed.
    void leave_piece(const Stretch& piece) noexcept;

    /// Bytes, roughly from above. @param delay of the pressure [samples]
    static double bytes(double delay) noexcept;

    static constexpr std::size_t moments = 4;  ///< polynomials across an interval

private:
    void make_kernel(const PlateResponse& response, double sample_period_s);
    void put_velocity(const kernels::PlateMotion::Velocity& of, const kernels::SampleTimes& times,
                      std::size_t count, double* out) const noexcept;
    double velocity(const kernels::PlateMotion::Velocity& of, double z) const noexcept;
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
    double sample_period_s_;
    bool has_pressure_ = false;
    double rho_c_ = 0;
    FixedTime delay_;  ///< of the pressure [samples]
    std::int64_t intervals_per_sample_ = 1;
    // integrals over intervals, [polynomial][mode], as kernels::add_moments has them
    std::size_t per_interval_ = 0;  ///< of them
    std::vector<double> kernel_;    ///< by intervals, the earliest first
    std::vector<double> history_;   ///< a ring of as many intervals
    std::vector<double> open_;      ///< of the interval that is not over
    std::int64_t line_ = 0;         ///< the end of that interval, counted in intervals
    double done_ = 0;               ///< of the present piece [z]
    std::vector<double> ring_;      ///< pressures by samples
};

}  // namespace hertzline
