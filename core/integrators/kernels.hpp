#pragma once
// The kernels of the grid integrators, the rows that they record on their way, and the instructions that all kernels use.

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include <Eigen/Core>

#include "hertzline/integrator.hpp"

namespace hertzline {
class Horn;
struct HornStep;
}  // namespace hertzline

namespace hertzline::kernels {

class SimdChain;

/// The largest number of rows that one step can add to a trace.
inline constexpr std::size_t max_rows_per_step = 96;

/// Where a kernel writes the motion of the probed bodies: one row per recorded moment, displacements, velocities
/// and accelerations of the probed bodies, [x...][v...][a...].
struct Trace {
    double* rows = nullptr;         ///< capacity * row_size
    double* fractions = nullptr;    ///< moment of each row within its step
    std::int64_t* steps = nullptr;  ///< step that the row's moment follows
    std::size_t capacity = 0;
    std::size_t count = 0;
    Eigen::Index first_body = 0;  ///< bodies [first_body, chain.bodies()) are probed
    Eigen::Index bodies = 0;
    std::int64_t next = never;  ///< step after which the next row is due, ...
    int every = 1;              ///< ... and how many steps later the one after it
    bool between = false;       ///< record contact events as well, for samples off the grid

    static constexpr std::int64_t never = -1;

    /// Whether the rows of another step fit; contact events add rows only between the samples' grid.
    bool has_room() const noexcept { return count + (between ? max_rows_per_step : 1) <= capacity; }
    /// How many of the steps from `step` on, at most max_steps, can be taken as one block: a row that shows
    /// more than the end of the chain needs all of it at one moment.
    std::int64_t steps_together(std::int64_t step, std::int64_t max_steps) const noexcept {
        constexpr Eigen::Index at_the_end = 2;
        const bool rows_due = between || next != never;
        std::int64_t together =
            rows_due ? std::min(max_steps, static_cast<std::int64_t>(capacity - count)) : max_steps;
        if (rows_due && bodies - first_body > at_the_end) {
            together = between ? 1 : std::min(together, next - step);
        }
        return std::max<std::int64_t>(together, 1);
    }
    std::size_t row_size() const noexcept { return 3 * static_cast<std::size_t>(bodies - first_body); }
};

/// Advances the chain by up to `count` steps, the first of them being step `first`.
/// @returns the steps taken: fewer when the trace has no room for another.
using Kernel = int (*)(SimdChain& chain, const Horn& prescribed, const HornStep* horn, std::int64_t first,
                       int count, Trace& trace);

/// The kernel for a grid integrator and a number of rows, for the widest SIMD instructions of this processor.
/// A series has none: null.
Kernel kernel(Integrator integrator, std::size_t rows) noexcept;

/// Doubles in a vector register of those instructions.
std::size_t kernel_lanes() noexcept;

/// Their name, e.g. "AVX3".
const char* kernel_target() noexcept;

}  // namespace hertzline::kernels
