#pragma once
// The topics that have subscribers, and since when.

#include <array>
#include <cstdint>

#include "core/taps.hpp"
#include "stream/pipeline/producer.hpp"
#include "stream/wire/publisher.hpp"

namespace hertzline::stream {

/// The taps of the stream that have subscribers. For the sending thread.
class TopicDemand {
public:
    /// @param always taps that are computed without subscribers, too: recorded ones
    TopicDemand(TapSet taps, TapSet always) noexcept : taps_(taps), always_(always & taps) {}

    /// Takes subscriptions from the publisher, and requests their taps from the producer.
    void update(const Publisher& publisher, Producer& producer) noexcept;

    /// Taps with a subscriber of their raw topic, and of their np topic.
    TapSet raw() const noexcept { return raw_; }
    TapSet np() const noexcept { return np_; }
    bool empty() const noexcept { return (raw_ | np_).empty(); }

    /// The demanded taps among those that a block was made for. An older block may hold a tap for a subscriber that
    /// has left: later blocks may lack it, so it is not sent to a new subscriber.
    TapSet met_by(const Demand& made_for) const noexcept;

private:
    TapSet taps_;
    TapSet always_;
    TapSet raw_;
    TapSet np_;
    std::array<std::uint32_t, tap_count> since_{};  // generation of the demand that began it, by tap
};

}  // namespace hertzline::stream
