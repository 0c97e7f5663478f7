// Replaces cvode.cpp and arkode.cpp where SUNDIALS is not installed.

#include "bench/peers/problem.hpp"

namespace hertzline::bench {

std::vector<Contender> cvode_contenders(const Problem&) {
    return {};
}
std::vector<Contender> arkode_contenders(const Problem&) {
    return {};
}

}  // namespace hertzline::bench
