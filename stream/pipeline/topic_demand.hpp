#pragma once
// The frames that subscribers ask for, and those of them that are made. For the sending thread.

#include <array>
#include <cstdint>

#include "hertzline/taps.hpp"
#include "stream/pipeline/producer.hpp"
#include "stream/wire/publisher.hpp"

namespace hertzline::stream {

/// Taps by the topic of their frames.
struct TapForms {
    TapSet raw;
    TapSet np;
    TapSet all() const noexcept { return raw | np; }
};

/// The taps of the stream that have subscribers. A tap is computed for those that take what they are sent, unless it is
/// shed (LoadShedder).
class TopicDemand {
public:
    /// @param always taps that are computed without subscribers, too: recorded ones
    TopicDemand(TapSet taps, TapSet always) noexcept : taps_(taps), always_(always & taps) {}

    /// Takes subscriptions from the publisher, and requests their taps but for the shed ones from the producer.
    void update(const Publisher& publisher, Producer& producer, TapSet shed) noexcept;

    /// Taps with a subscriber.
    const TapForms& asked() const noexcept { return asked_; }
    /// Taps with a subscriber that takes what it is sent.
    TapSet taken() const noexcept { return taken_.all(); }

    /// Notes the taps of a block. Blocks that lack a tap at first, as samples ahead of an array's delayed chains do, are none of its stream;
    /// a later one that lacks it is not sent, and counted.
    void note(const Block& block) noexcept;

    /// The asked taps that a block was made too early to know of are left out: an older block may hold a tap for a
    /// subscriber that has left, and later blocks may lack it, so it is not sent to a new subscriber.
    TapForms asked_of(const Block& block) const noexcept;
    /// Those of them that are sent.
    TapForms sent_of(const Block& block) const noexcept;

private:
    TapSet due_in(const Block& block) const noexcept;
    TapSet known_to(const Block& block) const noexcept;

    TapSet taps_;
    TapSet always_;
    TapSet shed_;
    TapForms asked_;
    TapForms taken_;
    TapSet begun_;                                  ///< asked taps that a block has had
    std::array<std::uint32_t, tap_count> since_{};  // generation of the demand that began it, by tap
};

}  // namespace hertzline::stream
