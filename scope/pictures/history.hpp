#pragma once
// The last samples of one stream, as a listener holds them for pictures.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace hertzline::scope {

/// A ring of samples of one channel. Samples are counted from the run's start. What is missing between two frames is held as
/// NaN.
class History {
public:
    /// @param capacity samples that are held, at least 1
    explicit History(std::size_t capacity);

    /// Appends samples. Before end() everything is forgotten first: another run has begun.
    void append(std::uint64_t first, std::span<const float> values);

    /// The samples that are held: from begin() to before end().
    std::uint64_t begin() const noexcept { return begin_; }
    std::uint64_t end() const noexcept { return end_; }
    std::size_t capacity() const noexcept { return values_.size(); }
    bool empty() const noexcept { return begin_ == end_; }

    /// Calls take(std::span<const float>) for the samples of [first, last) that are held, in their order, once or twice.
    template <class Take>
    void for_each_piece(std::uint64_t first, std::uint64_t last, Take take) const {
        first = std::max(first, begin_);
        last = std::min(last, end_);
        while (first < last) {
            const std::size_t place = place_of(first);
            const std::size_t count = std::min<std::uint64_t>(last - first, values_.size() - place);
            take(std::span<const float>(values_).subspan(place, count));
            first += count;
        }
    }

    /// One sample; NaN when it is not held.
    float at(std::uint64_t sample) const noexcept;

private:
    std::size_t place_of(std::uint64_t sample) const noexcept { return sample % values_.size(); }
    void fill_gap(std::uint64_t until);
    void put(std::uint64_t first, std::span<const float> values);

    std::vector<float> values_;
    std::uint64_t begin_ = 0;
    std::uint64_t end_ = 0;
};

}  // namespace hertzline::scope
