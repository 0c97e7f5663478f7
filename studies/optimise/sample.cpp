#include "studies/optimise/sample.hpp"

#include <cmath>
#include <random>

namespace hertzline::studies {

namespace {

/// From 0 to 1, without 1.
double share_of(std::uint64_t number) {
    constexpr int mantissa = 53;
    return std::ldexp(static_cast<double>(number >> (64 - mantissa)), -mantissa);
}

}  // namespace

SampleSequence::SampleSequence(std::size_t dimensions, std::uint64_t seed) : sequence_(dimensions) {
    std::mt19937_64 random(seed);
    for (std::size_t i = 0; i < dimensions; ++i) {
        shifts_.push_back(share_of(random()));
    }
}

Place SampleSequence::next() {
    Place place;
    for (const double shift : shifts_) {
        const double number = share_of(sequence_()) + shift;
        place.push_back(number < 1 ? number : number - 1);
    }
    return place;
}

}  // namespace hertzline::studies
