#pragma once
// Random numbers that are the same on every machine, as those of the standard's distributions are not.

#include <array>
#include <cmath>
#include <cstdint>

namespace hertzline::test {

/// S. Vigna's splitmix64.
class Draw {
public:
    explicit Draw(std::uint64_t seed) : state_(seed) {}

    double between(double least, double most) {
        return least + (most - least) * static_cast<double>(bits() >> 11U) * 0x1p-53;
    }
    /// Draws a number, evenly spread over the orders of magnitude.
    double magnitude(double least, double most) { return std::exp(between(std::log(least), std::log(most))); }
    std::int64_t whole(std::int64_t least, std::int64_t most) {
        return least + static_cast<std::int64_t>(bits() % static_cast<std::uint64_t>(most - least + 1));
    }
    bool one_in(std::uint64_t n) { return bits() % n == 0; }
    double zero_or(double value) { return one_in(4) ? 0 : value; }
    template <class Value, std::size_t n>
    Value any(const std::array<Value, n>& values) {
        return values[bits() % n];
    }
    /// Returns a generator for this number, independent of those of other numbers.
    Draw branch(std::uint64_t number) const {
        Draw mixed(state_);
        return Draw(mixed.bits() + number);
    }

private:
    std::uint64_t bits() {
        std::uint64_t z = state_ += 0x9e3779b97f4a7c15U;
        z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9U;
        z = (z ^ (z >> 27U)) * 0x94d049bb133111ebU;
        return z ^ (z >> 31U);
    }
    std::uint64_t state_;
};

}  // namespace hertzline::test
