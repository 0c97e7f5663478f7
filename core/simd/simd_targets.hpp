// The instruction sets that kernels are compiled for; the same in every file that has some. No include guard:
// included before highway.h in each of them.
//
// Three generations are enough (on x86: baseline, AVX2 with FMA, AVX-512); variable-length vectors
// (SVE, RVV) cannot be kept in arrays of registers, and have no operators. A build with a sanitizer does with fewer, as each takes a
// minute to compile there.
#ifndef HERTZLINE_OTHER_DISABLED_TARGETS
#define HERTZLINE_OTHER_DISABLED_TARGETS 0
#endif
#define HWY_DISABLED_TARGETS                                                                          \
    (HWY_SSSE3 | HWY_SSE4 | HWY_AVX3_DL | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV | \
     HERTZLINE_OTHER_DISABLED_TARGETS)

// Highway's assertions would call libhwy, which is not linked (dispatch.hpp).
#ifndef HWY_IS_DEBUG_BUILD
#define HWY_IS_DEBUG_BUILD 0
#endif
