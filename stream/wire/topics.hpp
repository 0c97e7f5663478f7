#pragma once
// The topics of a stream, as they are on the wire.

#include <algorithm>
#include <array>
#include <cstddef>
#include <string_view>

#include "hertzline/taps.hpp"

namespace hertzline::stream {

/// "v_out/np", put together by the compiler.
struct TopicText {
    std::array<char, 16> text{};
    std::size_t size = 0;

    constexpr TopicText() = default;
    constexpr TopicText(std::string_view tap, std::string_view form) {
        std::copy(tap.begin(), tap.end(), text.begin());
        text.at(tap.size()) = '/';
        std::copy(form.begin(), form.end(), text.begin() + static_cast<std::ptrdiff_t>(tap.size()) + 1);
        size = tap.size() + 1 + form.size();
    }
    constexpr operator std::string_view() const noexcept { return {text.data(), size}; }
};

/// The two topics of a tap.
struct TapTopics {
    TopicText raw;  ///< samples only
    TopicText np;   ///< JSON header, then samples
};

inline constexpr auto tap_topics = [] {
    std::array<TapTopics, tap_count> topics;
    for (const TapRow& row : tap_rows) {
        topics[static_cast<std::size_t>(row.tap)] = {{row.name, "raw"}, {row.name, "np"}};
    }
    return topics;
}();

constexpr const TapTopics& topics_of(Tap tap) noexcept {
    return tap_topics[static_cast<std::size_t>(tap)];
}

/// Topics that are not a tap's.
inline constexpr std::string_view meta_topic = "meta";
inline constexpr std::string_view meters_topic = "meters";
inline constexpr std::string_view end_topic = "end";

/// Every topic that a stream can have.
inline constexpr auto all_topics = [] {
    std::array<std::string_view, 2 * tap_count + 3> topics;
    std::size_t count = 0;
    for (const TapTopics& tap : tap_topics) {
        topics[count++] = tap.raw;
        topics[count++] = tap.np;
    }
    topics[count++] = meta_topic;
    topics[count++] = meters_topic;
    topics[count++] = end_topic;
    return topics;
}();

}  // namespace hertzline::stream
