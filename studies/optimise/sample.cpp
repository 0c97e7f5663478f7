#include "studies/optimise/sample.hpp"

#include <random>

namespace hertzline::studies {

SampleSequence::SampleSequence(std::size_t dimensions, std::uint64_t seed) : sequence_(dimensions) {
    std::mt19937_64 random(seed);
    for (std::size_t i = 0; i < dimensions; ++i) {
        shifts_.push_back(place_of(random()));
    }
}

Place SampleSequence::next() {
    Place place;
    for (const double shift : shifts_) {
        const double number = place_of(sequence_()) + shift;
        place.push_back(number < 1 ? number : number - 1);
    }
    return place;
}

}  // namespace hertzline::studies
