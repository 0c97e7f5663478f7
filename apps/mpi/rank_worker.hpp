#pragma once
// Every rank of a sweep but the first: runs the points that it is dealt.

#include "apps/mpi/ranks.hpp"

namespace hertzline::app {

/// Until rank 0 says that there is no more to do. Throws nothing: what goes wrong here rank 0 hears of.
void serve(Ranks& ranks) noexcept;

}  // namespace hertzline::app
