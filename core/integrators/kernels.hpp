#pragma once
// The kernels of the grid integrators, and the instructions that all kernels use.

#include <cstddef>
#include <cstdint>

#include "core/scene/integrator.hpp"

namespace hertzline {
class ToneBurst;
struct HornStep;
}  // namespace hertzline

namespace hertzline::kernels {

class SimdChain;
struct Trace;

/// Advances the chain by up to `count` steps, the first of them being step `first`.
/// @returns the steps taken: fewer when the trace has no room for another.
using Kernel = int (*)(SimdChain& chain, const ToneBurst& burst, const HornStep* horn, std::int64_t first,
                       int count, Trace& trace);

/// The kernel for a grid integrator and a number of rows, for the widest SIMD instructions of this processor.
/// A series has none: null.
Kernel kernel(Integrator integrator, std::size_t rows) noexcept;

/// Doubles in a vector register of those instructions.
std::size_t kernel_lanes() noexcept;

/// Their name, e.g. "AVX3".
const char* kernel_target() noexcept;

}  // namespace hertzline::kernels
