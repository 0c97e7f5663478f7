#include "scope/pictures/history.hpp"

#include <limits>

namespace hertzline::scope {

History::History(std::size_t capacity) : values_(std::max<std::size_t>(capacity, 1)) {}

void History::append(std::uint64_t first, std::span<const float> values) {
    const bool beyond = first > end_ && first - end_ >= values_.size();
    if (empty() || first < end_ || beyond) {
        begin_ = end_ = first;
    }
    fill_gap(first);
    if (values.size() > values_.size()) {
        const std::size_t passed_over = values.size() - values_.size();
        values = values.subspan(passed_over);
        begin_ = end_ = first + passed_over;
    }
    put(end_, values);
}

void History::fill_gap(std::uint64_t until) {
    for (; end_ < until; ++end_) {
        values_[place_of(end_)] = std::numeric_limits<float>::quiet_NaN();
    }
    begin_ = std::max(begin_, end_ - std::min<std::uint64_t>(end_, values_.size()));
}

void History::put(std::uint64_t first, std::span<const float> values) {
    const std::size_t place = place_of(first);
    const std::size_t until_the_end = std::min(values.size(), values_.size() - place);
    std::ranges::copy(values.first(until_the_end), values_.begin() + static_cast<std::ptrdiff_t>(place));
    std::ranges::copy(values.subspan(until_the_end), values_.begin());
    end_ = first + values.size();
    begin_ = std::max(begin_, end_ - std::min<std::uint64_t>(end_, values_.size()));
}

float History::at(std::uint64_t sample) const noexcept {
    const bool held = sample >= begin_ && sample < end_;
    return held ? values_[place_of(sample)] : std::numeric_limits<float>::quiet_NaN();
}

}  // namespace hertzline::scope
