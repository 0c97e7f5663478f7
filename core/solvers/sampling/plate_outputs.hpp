#pragma once
// The outputs of a modal plate: the mean velocity of its face, and the pressure at points of the fluid.
//
// The force of the last contact is all that the plate and its sound depend on. Over each interval of time its moments are added up; at
// an interval's end the pressures follow from the last moments and the states before them (core/plate/force_kernel.hpp). They depend
// neither on the pieces of the series nor on the sample rate. Each waits in a ring until it arrives.

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/integrators/plate_motion.hpp"
#include "core/integrators/series_piece.hpp"
#include "core/model/chain.hpp"
#include "core/plate/force_kernel.hpp"
#include "core/solvers/fixed_time.hpp"
#include "core/solvers/sampling/end_taps.hpp"
#include "hertzline/resolve.hpp"
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
                 const ResolvedScene& resolved, TapSet taps);

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

    /// Bytes, roughly from above. @param taps that the scene has
    static double bytes(const Scene& scene, TapSet taps) noexcept;

private:
    using Moments = std::array<double, moment_stride>;  // of the force over an interval

    /// The pressure at a point. Sample k is known at the end of the interval that begins at line k m - delay, m intervals in a sample.
    struct Pressure {
        ForceKernel kernel;
        std::int64_t delay;        ///< [intervals]
        double share;              ///< of that interval that is heard in the sample
        std::vector<double> ring;  ///< by samples
        Moments open{};            ///< of that share
        double& at(std::int64_t sample) noexcept {
            return ring[static_cast<std::size_t>(sample) % ring.size()];
        }
    };

    void put_velocity(const kernels::PlateMotion::Velocity& of, const kernels::SampleTimes& times,
                      std::size_t count, double* out) const noexcept;
    double velocity(const kernels::PlateMotion::Velocity& of, double z) const noexcept;
    double place_of(std::int64_t line, const Stretch& piece) const noexcept;
    void send(double until, const Stretch& piece) noexcept;
    void add_force(double until, double line, double interval) noexcept;
    void end_interval() noexcept;
    void put_pressures(const EndMotion& motion, std::size_t count, std::int64_t first) noexcept;
    double pressure(const Pressure& point) const noexcept;
    bool is_due(const Pressure& point) const noexcept {
        return (line_ - 1 + point.delay) % intervals_per_sample_ == 0;
    }
    double* states_at(std::int64_t line) noexcept {
        return states_.data() + static_cast<std::size_t>(line) % kept_ * 2 * forced_->size();
    }
    const double* states_at(std::int64_t line) const noexcept {
        return states_.data() + static_cast<std::size_t>(line) % kept_ * 2 * forced_->size();
    }

    kernels::PlateMotion* plate_;
    kernels::SeriesKernels kernels_;
    const kernels::SeriesPiece& piece_;
    double sample_period_s_;
    FixedTime first_delay_;  ///< of the nearest point [samples]: sound of line n m arrives there in sample n
    std::vector<Pressure> pressures_;  ///< at the hydrophone, if that is wanted, then at the points
    std::size_t on_axis_ = 0;          ///< how many of them are at the hydrophone
    std::int64_t soonest_ = 0;         ///< least of their delays [intervals]
    std::int64_t intervals_per_sample_ = 1;
    std::unique_ptr<const ForcedStates> forced_;
    std::size_t kept_ = 0;  ///< intervals in the rings
    std::vector<Moments>
        moments_;                 ///< a ring of intervals, twice over, so that any stretch lies in one piece
    std::vector<double> states_;  ///< a ring of the states at their ends
    Moments open_{};              ///< of the interval that is not over
    std::int64_t line_ = 0;       ///< its end, counted in intervals
    double done_ = 0;             ///< of the present piece [z]
};

}  // namespace hertzline
