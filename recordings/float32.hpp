#pragma once
// Samples as float32 little-endian, for the wire and SigMF files.

#include <cstddef>
#include <span>
#include <vector>

namespace hertzline::recordings {

/// Writes samples as float32 to `out`, which has as many.
/// @returns the number of samples that no finite float32 can hold: NaN, infinite, or beyond 3.4e38. They are written
/// as NaN. The caller must treat a frame with such samples as a failure.
[[nodiscard]] std::size_t to_float32(std::span<const double> samples, std::span<float> out) noexcept;

/// The bytes of float32 samples; a view, nothing is copied.
std::span<const std::byte> wire_bytes(std::span<const float> samples) noexcept;

/// Copies samples out of a payload, which may lie at any address. False, and nothing written, when the
/// payload is not a whole number of samples.
[[nodiscard]] bool decode_samples(std::span<const std::byte> payload, std::vector<float>& samples);

}  // namespace hertzline::recordings
