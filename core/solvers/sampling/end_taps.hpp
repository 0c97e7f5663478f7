#pragma once
// The taps that follow from the motion at the chain's far end: how each is computed, the same for every solver.

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>

#include "core/model/chain.hpp"
#include "core/model/horn.hpp"
#include "hertzline/samples.hpp"
#include "hertzline/simulation.hpp"

namespace hertzline {

/// The horn's motion at the samples. Computes a batch at a time: one sample at a time would take ten times as long as the rest of a
/// sample.
class HornAtSamples {
public:
    HornAtSamples(const Scene& scene, const SimulationOptions& options)
        : horn_(make_horn(scene.drive, 1 / scene.output.sample_rate_hz, options.live)) {}

    /// Where the motion jumps, that of the piece which begins there. @param sample index since the start
    const HornMotion& at(std::int64_t sample) noexcept {
        if (sample < first_ || sample >= first_ + Horn::batch_steps) {
            work_out(sample - sample % Horn::batch_steps);
        }
        return motion_[static_cast<std::size_t>(sample - first_)];
    }

private:
    void work_out(std::int64_t first) noexcept;

    std::unique_ptr<Horn> horn_;  ///< its steps are sample periods
    std::int64_t first_ = -Horn::batch_steps;
    std::array<HornMotion, Horn::batch_steps> motion_{};
};

/// The last sphere and the end at successive samples: columns, the first `count` numbers of which are there.
struct EndMotion {
    std::int64_t first = 0;      ///< index of the first sample
    std::size_t count = 0;       ///< samples
    double* v_last = nullptr;    ///< velocity of the last sphere [m/s]
    double* v_end = nullptr;     ///< of the end [m/s]
    double* x_last = nullptr;    ///< displacement of the last sphere [m]; null: not needed
    double* x_end = nullptr;     ///< of the end [m]; null: not needed
    bool* closed = nullptr;      ///< whether the last contact touches
    double* v_face = nullptr;    ///< of a modal plate [m/s]; null: not needed
    HornMotion* horn = nullptr;  ///< of a horn on which the chain acts back; null: it moves as prescribed
    double* p_axis = nullptr;    ///< of a modal plate [Pa]; null: not needed
    double* p_points = nullptr;  ///< of a modal plate [Pa], row-major [sample][point]; null: not needed
};

class EndTaps {
public:
    /// @param chain outlives the object
    EndTaps(const Chain& chain, const Scene& scene, const SimulationOptions& options);

    /// Most samples that are worked on at once.
    static constexpr std::size_t max_count = 256;

    /// Whether any of these taps follows from the motion of the end.
    static bool any_of(TapSet taps) noexcept;

    HornAtSamples& horn() noexcept { return horn_; }

private:
    friend class EndTapsWriter;

    /// Columns for the motion of the next samples: those of the block that are the motion itself, else scratch.
    EndMotion outputs_into(Samples& samples) noexcept;
    void fill(Samples& samples, const EndMotion& motion) noexcept;

    const Chain& chain_;
    HornAtSamples horn_;
    bool resonates_;  ///< the horn: the solver knows its motion
    std::array<HornMotion, max_count> horn_motion_{};
    std::array<double, max_count> v_last_{}, v_end_{}, x_last_{}, x_end_{}, v_face_{};
    std::array<bool, max_count> closed_{};
};

/// Adds samples to a block: a solver puts the motion of the end into motion(), and the taps are computed from it, many samples at
/// a time. The block's count is right when the writer is gone.
class EndTapsWriter {
public:
    EndTapsWriter(EndTaps& taps, Samples& samples) noexcept
        : taps_(taps),
          samples_(samples),
          motion_(taps.outputs_into(samples)),
          shows_end_(EndTaps::any_of(samples.holds)) {}
    EndTapsWriter(const EndTapsWriter&) = delete;
    EndTapsWriter& operator=(const EndTapsWriter&) = delete;
    ~EndTapsWriter() { fill(); }

    Samples& samples() const noexcept { return samples_; }
    /// Whether the block holds a tap that follows from the motion of the end.
    bool shows_end() const noexcept { return shows_end_; }
    /// Index in the block of the sample that comes next.
    std::size_t next() const noexcept { return samples_.count + motion_.count; }
    /// Samples that may be put into motion() before advance(), 1 at least.
    std::size_t room() const noexcept { return EndTaps::max_count - motion_.count; }
    /// The next sample is put at [count]. Where the samples hold the velocities themselves, they are columns of the samples.
    const EndMotion& motion() const noexcept { return motion_; }
    /// So many samples have been put. @param count at most room()
    void advance(std::size_t count) noexcept {
        motion_.count += count;
        if (motion_.count == EndTaps::max_count) {
            fill();
            motion_ = taps_.outputs_into(samples_);
        }
    }

private:
    void fill() noexcept {
        taps_.fill(samples_, motion_);
        samples_.count += motion_.count;
    }

    EndTaps& taps_;
    Samples& samples_;
    EndMotion motion_;
    bool shows_end_;
};

}  // namespace hertzline
