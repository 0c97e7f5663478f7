#include "core/solvers/fixed_time.hpp"

namespace hertzline {

FixedTime FixedTime::of(double time) noexcept {
    const auto whole = static_cast<std::int64_t>(time);  // not negative: the same as floor, but quicker
    return {whole, static_cast<std::uint64_t>((time - static_cast<double>(whole)) * 0x1p64)};
}

FixedTime FixedTime::times(std::int64_t n) const noexcept {
    // schoolbook multiplication of the 64-bit fraction, in halves
    const auto count = static_cast<std::uint64_t>(n);
    const std::uint64_t mask = 0xffffffffU;
    const std::uint64_t low = (part & mask) * (count & mask);
    const std::uint64_t middle = (part >> 32U) * (count & mask) + (low >> 32U);
    const std::uint64_t other = (part & mask) * (count >> 32U) + (middle & mask);
    const std::uint64_t carry = (part >> 32U) * (count >> 32U) + (middle >> 32U) + (other >> 32U);
    return {whole * n + static_cast<std::int64_t>(carry), part * count};
}

double difference(FixedTime a, FixedTime b) noexcept {
    return static_cast<double>(a.whole - b.whole) + (a.fraction() - b.fraction());
}

}  // namespace hertzline
