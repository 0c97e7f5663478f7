#pragma once
// Time as a fixed-point number, so that the moment of a sample does not drift.

#include <cstdint>

namespace hertzline {

/// A time with 64 bits before and 64 behind the point, in a unit that its owner names: steps of a grid, or sample periods. Adding a
/// period again and again is exact but for the period's own rounding: after 1e12 additions the time is off by 5e-8 units.
struct FixedTime {
    std::int64_t whole = 0;
    std::uint64_t part = 0;  ///< behind the point, in units of 2^-64

    /// @param time not negative
    static FixedTime of(double time) noexcept;
    double fraction() const noexcept { return static_cast<double>(part >> 11U) * 0x1p-53; }
    void advance(FixedTime by) noexcept {
        part += by.part;
        whole += by.whole + (part < by.part ? 1 : 0);
    }
    /// n times this one, from 0.
    FixedTime times(std::int64_t n) const noexcept;
    /// The first whole time that is not before this one.
    std::int64_t rounded_up() const noexcept { return whole + (part > 0 ? 1 : 0); }
};

/// a - b, as exactly as a double can say it.
double difference(FixedTime a, FixedTime b) noexcept;

}  // namespace hertzline
