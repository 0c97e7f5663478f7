#pragma once
// Places of a search's global sample: Sobol's sequence, shifted by the seed.

#include <cstdint>
#include <vector>

#include "studies/optimise/search_space.hpp"
#include <boost/random/sobol.hpp>

namespace hertzline::studies {

/// Fills the cube more evenly than random places do, however many are taken. Each seed shifts the sequence as a whole, modulo 1
/// (R. Cranley and T. N. L. Patterson, SIAM J. Numer. Anal. 13 (1976) 904).
class SampleSequence {
public:
    SampleSequence(std::size_t dimensions, std::uint64_t seed);

    Place next();

private:
    boost::random::sobol sequence_;
    std::vector<double> shifts_;
};

}  // namespace hertzline::studies
