#pragma once
// Where the samples of a stream come from: a simulation, or a recording that is played again.

#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>

#include "core/model/bursts.hpp"
#include "core/samples.hpp"
#include "core/simulation.hpp"
#include "core/taps.hpp"

namespace hertzline::stream {

/// How far a source has come; all 0 where it knows nothing of steps and energy.
struct SourceAccount {
    std::int64_t steps = 0;
    std::int64_t contact_events = 0;
};

/// What a stream consists of.
struct StreamFormat {
    TapSet taps;              ///< that there are
    std::size_t spheres = 0;  ///< of the chain: they say how many channels a tap has
    double sample_rate_hz = 0;
    std::int64_t frame_samples = 0;
    double repetition_hz = 0;  ///< bursts a second; 0: a single one, or it is not known

    std::size_t channels(Tap tap) const noexcept { return channels_of(tap, spheres); }
    /// The taps with a channel for each sphere or contact.
    TapSet of_chain() const noexcept { return taps & chain_taps; }
};

/// Everything but the construction and interrupt() happens in the simulating thread.
class SampleSource {
public:
    virtual ~SampleSource() = default;

    virtual StreamFormat format() const = 0;

    /// Room for a frame of these taps, which read() fills.
    Samples make_block(TapSet taps) const {
        const StreamFormat is = format();
        return {taps & is.taps, is.spheres, static_cast<std::size_t>(is.frame_samples)};
    }

    /// The next samples of the wanted taps, at most `count` and fewer only where the source has a gap; their
    /// index is in samples.first. False when there are no more, at the end or after a failure.
    virtual bool read(Samples& samples, std::size_t count, TapSet wanted) noexcept = 0;

    /// Passes over `count` samples. False as above.
    virtual bool skip(std::int64_t count) noexcept = 0;

    /// Makes read() and skip() return soon, with false; from another thread. For sources whose blocks take long.
    virtual void interrupt() noexcept {}

    /// How many samples may be read or passed over at once: a block ends where the scene changes. At least 1.
    virtual std::int64_t samples_to_change() noexcept { return std::numeric_limits<std::int64_t>::max(); }

    /// That of the sample that comes next, after samples_to_change().
    virtual Epoch epoch() const noexcept { return {.repetition_hz = format().repetition_hz}; }

    /// Index of the sample that comes next.
    virtual std::int64_t next_sample() const noexcept = 0;

    virtual SourceAccount account() const noexcept { return {}; }

    /// How far the motion has gone; all 0 where it is not known. Not cheap.
    virtual MotionExtremes motion() noexcept { return {}; }

    /// What went wrong, for a human; empty when nothing did.
    virtual std::string failure() const { return {}; }
};

}  // namespace hertzline::stream
