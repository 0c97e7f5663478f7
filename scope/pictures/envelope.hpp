#pragma once
// Many samples as few pixels, without losing any: the smallest and the largest sample of each column.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "scope/pictures/history.hpp"

namespace hertzline::scope {

/// The smallest and the largest sample of each column; NaN where none is held.
struct Envelope {
    std::vector<float> low;
    std::vector<float> high;
};

/// Column i of C holds the samples from first + i count / C to before first + (i + 1) count / C, rounded down: each sample of
/// the window lies in exactly one. Samples that are missing are passed over.
/// @param first may lie before the first sample of the run @param columns at least 1
Envelope envelope(const History& history, std::int64_t first, std::uint64_t count, std::size_t columns);

}  // namespace hertzline::scope
