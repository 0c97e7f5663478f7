#pragma once
// The taps that are left out where there is not time for all that subscribers want: the largest first, so that the small ones
// keep pace. It looks at lateness alone, whoever causes it: the simulation, the sending, or other programs.

#include <cstdint>

#include "hertzline/taps.hpp"
#include "stream/inputs/sample_source.hpp"
#include "stream/pipeline/pacer.hpp"

namespace hertzline::stream {

class LoadShedder {
public:
    /// Half of the ring's 50 ms: a stream that is later, and does not catch up, is about to discard whole blocks.
    static constexpr Nanoseconds behind = std::chrono::milliseconds(25);
    /// Time between two judgements, in which a stream that was held up catches up.
    static constexpr Nanoseconds period = std::chrono::milliseconds(5);
    /// The taps come back after this time, when the stream is in time. If they have to be shed again within as long, the
    /// next time is twice as long, up to the longest.
    static constexpr Nanoseconds rest = std::chrono::seconds(1);
    static constexpr Nanoseconds longest_rest = std::chrono::minutes(1);
    /// A stream that is as late as this although all but one tap are shed cannot be helped: all are sent again.
    static constexpr Nanoseconds hopeless = std::chrono::seconds(1);

    explicit LoadShedder(const StreamFormat& format) noexcept : format_(format) {}

    /// Judges the stream. At least one of the taken taps remains.
    /// @param taken the taps that subscribers take @param lateness of the block that is to be sent
    /// @param dropped blocks that the stream has discarded so far @param now never falls
    void judge(TapSet taken, Nanoseconds lateness, std::uint64_t dropped, Nanoseconds now) noexcept;

    /// The taps that are left out at present.
    TapSet shed() const noexcept { return shed_; }

private:
    Tap largest(TapSet taps) const noexcept;
    void shed_one(TapSet of, Nanoseconds now) noexcept;

    StreamFormat format_;
    TapSet shed_;
    bool gave_up_ = false;  // until it is in time again
    // At the last judgement.
    Nanoseconds judged_at_{-period};
    Nanoseconds lateness_{0};
    std::uint64_t dropped_ = 0;
    bool was_behind_ = false;
    // All taps came back, and come back when they are shed.
    Nanoseconds came_back_at_{-longest_rest};
    Nanoseconds comes_back_at_{0};
    Nanoseconds rest_ = rest;
};

}  // namespace hertzline::stream
