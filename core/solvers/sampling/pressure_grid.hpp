#pragma once
// The pressures that the sounds of a plate make at points of the fluid, on a grid of equal intervals of time.
//
// The force of the last contact is all that the plate and its sound depend on. Over each interval of time its moments are added up; at
// an interval's end the pressures follow from the last moments and the states before them (core/plate/force_kernel.hpp). They depend
// neither on the pieces of the series nor on the sample rate. Each waits in a ring until it arrives.

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/integrators/plate_motion.hpp"
#include "core/integrators/series_piece.hpp"
#include "core/plate/force_kernel.hpp"
#include "core/plate/point_sound.hpp"
#include "core/solvers/fixed_time.hpp"
#include "core/solvers/sampling/end_taps.hpp"

namespace hertzline {

/// Where a piece begins and ends [samples].
struct Stretch {
    FixedTime begin;
    FixedTime end;
};

/// A sound at a point, by its number.
struct SoundAtPoint {
    std::size_t point;
    SoundSum sound;
};

class PressureGrid {
public:
    /// All but the sounds outlive the object. @param sounds at least one @param intervals_per_sample as many as the shortest of them needs
    PressureGrid(const PlateResponse& response, const kernels::PlateMotion& plate,
                 const kernels::SeriesPiece& piece, const kernels::SeriesKernels& kernels,
                 double sample_period_s, const std::vector<SoundAtPoint>& sounds,
                 std::int64_t intervals_per_sample);

    /// Back to sample 0: no sound on its way.
    void reset() noexcept;

    /// Takes over the sound on its way, of a grid that is equal to this one. Allocates nothing. @param samples number there of sample 0 here
    void continue_from(const PressureGrid& before, std::int64_t samples) noexcept;

    /// Sends what the samples up to `last` hear of the present piece, which may be longer than the way.
    void send_for(std::int64_t last, const Stretch& piece) noexcept;
    /// The piece is done: all that it sends is computed.
    void leave_piece(const Stretch& piece) noexcept;

    /// Adds the pressures that arrive in `count` samples. @param column_of takes a point's number, gives its first value, or null, and
    /// the distance to the next one
    template <class ColumnOf>
    void add_to(std::int64_t first, std::size_t count, const ColumnOf& column_of) noexcept {
        for (Pressure& pressure : pressures_) {
            const auto [out, stride] = column_of(pressure.point);
            for (std::size_t i = 0; out != nullptr && i < count; ++i) {
                out[i * stride] += pressure.at(first + static_cast<std::int64_t>(i));
            }
        }
    }

private:
    using Moments = std::array<double, moment_stride>;  // of the force over an interval

    /// A pressure. Sample k is known at the end of the interval that begins at line k m - delay, m intervals in a sample.
    struct Pressure {
        std::size_t point = 0;
        ForceKernel kernel;
        std::int64_t delay;        ///< [intervals]
        double share;              ///< of that interval that is heard in the sample
        std::vector<double> ring;  ///< by samples
        Moments open{};            ///< of that share
        double& at(std::int64_t sample) noexcept {
            return ring[static_cast<std::size_t>(sample) % ring.size()];
        }
    };

    double place_of(std::int64_t line, const Stretch& piece) const noexcept;
    void send(double until, const Stretch& piece) noexcept;
    void add_force(double until, double line, double interval) noexcept;
    void end_interval() noexcept;
    double value(const Pressure& pressure) const noexcept;
    double force_at(double z) const noexcept;
    void note_jump(const Stretch& piece) noexcept;
    double samples_after(FixedTime moment, std::int64_t line) const noexcept;
    double age_of(FixedTime moment) const noexcept;
    bool is_due(const Pressure& pressure) const noexcept {
        return (line_ - 1 + pressure.delay) % intervals_per_sample_ == 0;
    }
    double* states_at(std::int64_t line) noexcept {
        return states_.data() + static_cast<std::size_t>(line) % kept_ * 2 * forced_.size();
    }
    const double* states_at(std::int64_t line) const noexcept {
        return states_.data() + static_cast<std::size_t>(line) % kept_ * 2 * forced_.size();
    }

    const kernels::PlateMotion& plate_;
    const kernels::SeriesPiece& piece_;
    kernels::SeriesKernels kernels_;
    double sample_period_s_;
    std::int64_t intervals_per_sample_;
    ForcedStates forced_;
    /// The delay of the first sound [samples]. With m intervals in a sample, the sound of line n * m arrives in sample n.
    FixedTime first_delay_;
    std::vector<Pressure> pressures_;
    std::int64_t soonest_ = 0;  ///< least of their delays [intervals]
    std::size_t kept_ = 0;      ///< intervals in the rings
    std::vector<Moments>
        moments_;                 ///< a ring of intervals, twice over, so that any stretch lies in one piece
    std::vector<double> states_;  ///< a ring of the states at their ends
    Moments open_{};              ///< of the interval that is not over
    std::int64_t line_ = 0;       ///< its end, counted in intervals
    double done_ = 0;             ///< of the present piece [z]

    /// Where the force jumps, as that of a dashpot does when its contact closes or opens.
    struct Jump {
        FixedTime at;  ///< [samples]
        double force;  ///< by so much [N]
    };
    static constexpr std::size_t most_jumps = 32;
    std::array<Jump, most_jumps> jumps_{};  ///< that are heard
    std::size_t jumps_heard_ = 0;
    double force_before_ = 0;   ///< at the end of the piece before [N]
    double largest_force_ = 0;  ///< at the begin of any piece so far [N]
    bool begins_ = true;        ///< the present piece has not been looked at
};

}  // namespace hertzline
