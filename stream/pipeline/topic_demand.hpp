#pragma once
// Which topics subscribers want, and since when.

#include <array>
#include <cstdint>

#include "core/taps.hpp"
#include "stream/pipeline/producer.hpp"
#include "stream/wire/publisher.hpp"

namespace hertzline::stream {

/// What somebody subscribes to, of the taps that the stream has. For the sending thread.
class TopicDemand {
public:
    /// @param always taps that are computed whether or not somebody subscribes: those that are recorded
    TopicDemand(TapSet taps, TapSet always) noexcept : taps_(taps), always_(always & taps) {}

    /// Asks the publisher what is wanted now, and the producer to compute it.
    void update(const Publisher& publisher, Producer& producer) noexcept;

    /// Taps whose raw topic is wanted, and those whose np topic is.
    TapSet raw() const noexcept { return raw_; }
    TapSet np() const noexcept { return np_; }
    bool empty() const noexcept { return (raw_ | np_).empty(); }

    /// The wanted taps among those that a block was made for. An older block may hold a tap for a subscriber
    /// that has left: the blocks that follow need not have it, so it is not sent to one that has just come.
    TapSet met_by(const Demand& made_for) const noexcept;

private:
    TapSet taps_;
    TapSet always_;
    TapSet raw_;
    TapSet np_;
    std::array<std::uint32_t, tap_count> since_{};  // generation of the demand that began it, by tap
};

}  // namespace hertzline::stream
