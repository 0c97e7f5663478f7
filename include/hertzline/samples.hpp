#pragma once
// The output of a simulation: blocks of samples.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <new>
#include <span>
#include <vector>

#include "hertzline/taps.hpp"

namespace hertzline {

/// A block of samples: a column for each tap. Sized once, filled by Simulation::advance().
class Samples {
public:
    /// Room for `capacity` samples of those taps. @throws std::bad_alloc
    Samples(TapSet taps, const ChannelCounts& counts, std::size_t capacity)
        : capacity_(capacity), counts_(counts), taps_(taps) {
        for (const Tap tap : taps) {
            std::vector<double>& column = columns_[static_cast<std::size_t>(tap)];
            if (channels(tap) > 0 && capacity > column.max_size() / channels(tap)) {
                throw std::bad_alloc();
            }
            column.resize(capacity * channels(tap));
        }
    }

    std::int64_t first = 0;  ///< index of the first sample since the start
    std::size_t count = 0;   ///< samples in this block
    TapSet holds;            ///< the taps that are filled

    std::size_t capacity() const noexcept { return capacity_; }
    const ChannelCounts& counts() const noexcept { return counts_; }
    std::size_t spheres() const noexcept { return counts_.spheres; }
    std::size_t channels(Tap tap) const noexcept { return channels_of(tap, counts_); }
    TapSet taps() const noexcept { return taps_; }  ///< the taps for which the block has room

    /// The tap's values, row-major [sample][channel], in its unit; empty for a tap without room.
    std::span<const double> operator[](Tap tap) const noexcept {
        const std::vector<double>& column = columns_[static_cast<std::size_t>(tap)];
        return {column.data(), column.empty() ? 0 : count * channels(tap)};
    }

    /// Takes the first samples out of the block. @param samples at most count
    void drop(std::size_t samples) noexcept {
        for (const Tap tap : taps_) {
            std::vector<double>& column = columns_[static_cast<std::size_t>(tap)];
            const std::size_t numbers = samples * channels(tap);
            std::copy(column.begin() + static_cast<std::ptrdiff_t>(numbers),
                      column.begin() + static_cast<std::ptrdiff_t>(count * channels(tap)), column.begin());
        }
        first += static_cast<std::int64_t>(samples);
        count -= samples;
    }

    /// All the room of a tap, to be filled.
    std::span<double> room(Tap tap) noexcept { return columns_[static_cast<std::size_t>(tap)]; }

private:
    std::size_t capacity_;
    ChannelCounts counts_;
    TapSet taps_;
    std::array<std::vector<double>, tap_count> columns_;
};

}  // namespace hertzline
