#include "scope/pictures/envelope.hpp"

#include <algorithm>
#include <limits>
#include <span>

namespace hertzline::scope {

namespace {

struct Extremes {
    float low = std::numeric_limits<float>::infinity();
    float high = -std::numeric_limits<float>::infinity();
};

/// A comparison with NaN is false, so NaN changes nothing.
Extremes extremes_of(std::span<const float> values, Extremes so_far) noexcept {
    for (const float value : values) {
        so_far.low = value < so_far.low ? value : so_far.low;
        so_far.high = value > so_far.high ? value : so_far.high;
    }
    return so_far;
}

std::uint64_t not_before_the_run(std::int64_t sample) noexcept {
    return static_cast<std::uint64_t>(std::max<std::int64_t>(sample, 0));
}

}  // namespace

Envelope envelope(const History& history, std::int64_t first, std::uint64_t count, std::size_t columns) {
    constexpr float nothing = std::numeric_limits<float>::quiet_NaN();
    Envelope result{std::vector<float>(columns, nothing), std::vector<float>(columns, nothing)};
    for (std::size_t column = 0; column < columns; ++column) {
        const auto from = first + static_cast<std::int64_t>(column * count / columns);
        const auto to = first + static_cast<std::int64_t>((column + 1) * count / columns);
        Extremes extremes;
        history.for_each_piece(
            not_before_the_run(from), not_before_the_run(to),
            [&](std::span<const float> piece) { extremes = extremes_of(piece, extremes); });
        if (extremes.low <= extremes.high) {
            result.low[column] = extremes.low;
            result.high[column] = extremes.high;
        }
    }
    return result;
}

}  // namespace hertzline::scope
