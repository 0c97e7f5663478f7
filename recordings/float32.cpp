#include "recordings/float32.hpp"

#include <bit>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

namespace hertzline::recordings {

namespace {

static_assert(std::endian::native == std::endian::little,
              "samples go on the wire in memory order; a big-endian machine has to swap them");
static_assert(std::numeric_limits<float>::is_iec559 && sizeof(float) == 4);

/// In absolute value; false for NaN. By its bits: of a comparison of numbers no vector instruction is made.
bool is_below_largest(float number) {
    constexpr auto largest = std::bit_cast<std::uint32_t>(std::numeric_limits<float>::max());
    return (std::bit_cast<std::uint32_t>(number) & 0x7fffffffU) < largest;
}

/// Slow, for a run that failed: replaces numbers beyond the largest float by NaN and counts them.
std::size_t replace_unrepresentable(std::span<const double> samples, std::span<float> out) {
    constexpr double largest = std::numeric_limits<float>::max();
    std::size_t unrepresentable = 0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
        if (!(std::abs(samples[i]) <= largest)) {  // or NaN
            out[i] = std::numeric_limits<float>::quiet_NaN();
            ++unrepresentable;
        }
    }
    return unrepresentable;
}

}  // namespace

std::size_t to_float32(std::span<const double> samples, std::span<float> out) noexcept {
    assert(samples.size() == out.size());
    // Plain loops over plain pointers, of which the compiler makes vector instructions.
    const double* const from = samples.data();
    float* const to = out.data();
    for (std::size_t i = 0; i < samples.size(); ++i) {
        to[i] = static_cast<float>(from[i]);  // infinite beyond the largest float (IEC 559)
    }
    std::uint32_t suspicious = 0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
        suspicious |= is_below_largest(to[i]) ? 0U : 1U;
    }
    return suspicious == 0 ? 0 : replace_unrepresentable(samples, out);
}

std::span<const std::byte> wire_bytes(std::span<const float> samples) noexcept {
    return std::as_bytes(samples);
}

bool decode_samples(std::span<const std::byte> payload, std::vector<float>& samples) {
    if (payload.size() % sizeof(float) != 0) {
        return false;
    }
    samples.resize(payload.size() / sizeof(float));
    if (!samples.empty()) {
        std::memcpy(samples.data(), payload.data(), payload.size());
    }
    return true;
}

}  // namespace hertzline::recordings
