#pragma once
// Where the samples of a stream come from: a simulation, or a recording that is played again.

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "core/model/bursts.hpp"
#include "hertzline/samples.hpp"
#include "hertzline/simulation.hpp"
#include "hertzline/taps.hpp"

namespace hertzline::stream {

/// The work of a source so far; all 0 for one without steps.
struct SourceAccount {
    std::int64_t steps = 0;
    std::int64_t contact_events = 0;
    /// Of the present motion, or the largest of those that another scene has ended.
    double energy_residual = 0;
};

/// Samples of a live drive so far.
struct DriveCounts {
    std::uint64_t samples = 0;    ///< that moved the horn
    std::uint64_t underruns = 0;  ///< how often they came too late
    std::uint64_t zeros = 0;      ///< that took the place of late ones
    std::uint64_t lost = 0;       ///< missing between two frames; zeros take their place up to ten seconds
    std::uint64_t refused = 0;    ///< messages that were left out
};

/// The form of a stream's samples.
struct StreamFormat {
    TapSet taps;  ///< the available ones
    ChannelCounts counts;
    double sample_rate_hz = 0;
    std::int64_t frame_samples = 0;
    double repetition_hz = 0;  ///< bursts a second; 0: a single one, or it is not known
    /// Of a live drive: so many samples later its samples are heard.
    std::optional<std::int64_t> latency_samples = {};

    std::size_t channels(Tap tap) const noexcept { return channels_of(tap, counts); }
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
        return {taps & is.taps, is.counts, static_cast<std::size_t>(is.frame_samples)};
    }

    /// Waits until the next `count` samples can be made; call it before read() or skip(). False: never, as there are no more.
    virtual bool wait_for(std::int64_t /*count*/) noexcept { return true; }

    /// The next samples of the wanted taps, at most `count` and fewer only where the source has a gap; their
    /// index is in samples.first. False when there are no more, at the end or after a failure.
    virtual bool read(Samples& samples, std::size_t count, TapSet wanted) noexcept = 0;

    /// Passes over `count` samples. False as above.
    virtual bool skip(std::int64_t count) noexcept = 0;

    /// Makes read() and skip() return soon, with false; from another thread. For sources whose blocks take long.
    virtual void interrupt() noexcept {}

    /// Ends what works beside it, after the last read(); its counts change no more.
    virtual void end() noexcept {}

    /// Returns the number of samples up to the next change of the scene, at which a block ends; at least 1.
    virtual std::int64_t samples_to_change() noexcept { return std::numeric_limits<std::int64_t>::max(); }

    /// Returns the epoch of the next sample; call samples_to_change() before.
    virtual Epoch epoch() const noexcept { return {.repetition_hz = format().repetition_hz}; }

    /// Returns the index of the next sample.
    virtual std::int64_t next_sample() const noexcept = 0;

    virtual SourceAccount account() noexcept { return {}; }

    /// Returns the samples of a live drive so far; nothing where there is none. From any thread.
    virtual std::optional<DriveCounts> drive() const noexcept { return std::nullopt; }
    /// Returns sentences for the user since the last call. From any thread.
    virtual std::vector<std::string> take_warnings() { return {}; }

    /// Returns the extremes of the motion; all 0 where it is not known. Not cheap.
    virtual MotionExtremes motion() noexcept { return {}; }

    /// Returns the fault that ended the source, for a human; empty: none.
    virtual std::string failure() const { return {}; }
};

}  // namespace hertzline::stream
