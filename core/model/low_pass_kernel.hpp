#pragma once
// The sums of a low-pass, in vectors as wide as the processor has.

#include <cstddef>

namespace hertzline::kernels {

/// Knots whose values are found at once; side by side in memory are their samples.
inline constexpr std::size_t low_pass_block = 64;

/// values[k] = taps[0] samples[places[0] + k] + the sum of taps[j] (samples[places[j] + k] + samples[places[-j] + k]) for j from 1 on, in
/// this order. The bits are the same with all instruction sets. @param count of the taps
void low_pass(const double* samples, const double* taps, std::size_t count, const std::ptrdiff_t* places,
              double* values) noexcept;

}  // namespace hertzline::kernels
