#pragma once
// One channel of a stream, which is what pages show.

#include <compare>
#include <cstddef>
#include <optional>
#include <string_view>

#include "hertzline/taps.hpp"

namespace hertzline::scope {

/// "v_out", or "v_last[3]" of the third element of an array: channels count from 1, as entries of lists do.
struct Channel {
    Tap tap = Tap::v_out;
    std::size_t number = 1;
    bool operator==(const Channel&) const noexcept = default;
    bool operator<(const Channel& other) const noexcept {
        return tap != other.tap ? tap < other.tap : number < other.number;
    }
};

/// The streams whose channels are shown one by one. Those of whole chains are pictures of their own.
inline constexpr TapSet pictured_taps = streamed_taps - chain_taps;

/// Returns the channel of that name; nothing when there is none. A name without a number is the first channel.
std::optional<Channel> channel_named(std::string_view name) noexcept;

}  // namespace hertzline::scope
