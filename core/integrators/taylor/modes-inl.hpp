// The velocities of a modal plate's modes over a piece: polynomials in z, side by side. Included once per SIMD target.
#if defined(HERTZLINE_MODES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HERTZLINE_MODES_INL
#undef HERTZLINE_MODES_INL
#else
#define HERTZLINE_MODES_INL
#endif

#include <algorithm>
#include <array>

#include "core/integrators/plate_motion.hpp"
#include "core/integrators/series_piece.hpp"
#include "core/integrators/simd/vectors-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace hertzline::kernels {
namespace HWY_NAMESPACE {

// Most plates have four modes or fewer.
using ModeTag = hn::CappedTag<double, 4>;
using ModeVec = hn::Vec<ModeTag>;

constexpr std::size_t moment_count = 4;  // Legendre's polynomials in add_moments()

/// Calls visit(first) for each vector of modes.
template <class Visit>
HWY_INLINE void each_vector_of_modes(const PlateMotion& plate, Visit&& visit) {
    for (std::size_t n = 0; n < plate.modes(); n += hn::Lanes(ModeTag())) {
        visit(n);
    }
}

HWY_INLINE double sum_of_modes(ModeVec values) {
    return GetLane(hn::SumOfLanes(ModeTag(), values));
}

/// A polynomial of the modes at some places side by side. @param terms those of the first vector
template <std::size_t Count>
HWY_INLINE std::array<ModeVec, Count> polynomial_at(const double* terms, std::size_t stride, int degree,
                                                    const std::array<double, Count>& z) {
    std::array<ModeVec, Count> sums;
    sums.fill(hn::Zero(ModeTag()));
    for (int k = degree; k-- > 0;) {
        const ModeVec term = hn::Load(ModeTag(), terms + static_cast<std::size_t>(k) * stride);
        for (std::size_t i = 0; i < Count; ++i) {
            sums[i] = MulAdd(sums[i], hn::Set(ModeTag(), z[i]), term);
        }
    }
    return sums;
}

/// The modes' velocities at some places.
template <std::size_t Count>
HWY_INLINE std::array<ModeVec, Count> modes_at(const PlateMotion& plate, int degree, std::size_t first,
                                               const std::array<double, Count>& z) {
    auto sums = polynomial_at(plate.mode_terms() + first, plate.stride(), degree, z);
    for (std::size_t force = 0; force < plate.onset_forces.size(); ++force) {
        const auto added = polynomial_at(plate.onset_terms(force) + first, plate.stride(), degree, z);
        for (std::size_t i = 0; i < Count; ++i) {
            const double power = plate.onset_forces[force].integrated_power(std::max(z[i], 0.0));
            sums[i] = MulAdd(hn::Set(ModeTag(), power), added[i], sums[i]);
        }
    }
    return sums;
}

/// Losses in the plate's material over the piece [J].
template <class Nodes>
HWY_INLINE double losses(const PlateMotion& plate, int degree, double length) {
    auto z = Nodes::node;
    for (double& place : z) {
        place *= length;
    }
    double lost = 0;
    each_vector_of_modes(plate, [&](std::size_t first) HWY_ATTR {
        ModeVec sum = hn::Zero(ModeTag());
        const auto v = modes_at(plate, degree, first, z);
        for (std::size_t i = 0; i < z.size(); ++i) {
            sum = MulAdd(hn::Set(ModeTag(), Nodes::weight[i]) * v[i], v[i], sum);
        }
        lost += length * sum_of_modes(sum * hn::Load(ModeTag(), plate.mode_losses() + first));
    });
    return lost;
}

/// Adds the integrals over a part of an interval, with Legendre's polynomials as weights.
inline void add_moments(const PlateMotion& plate, int degree, const PlateInterval& part, double* moments) {
    // Gauss and Legendre with four nodes (Abramowitz and Stegun, table 25.4)
    constexpr std::array node{0.0694318442029737, 0.3300094782075719, 0.6699905217924281, 0.9305681557970263};
    constexpr std::array weight{0.1739274225687269, 0.3260725774312731, 0.3260725774312731,
                                0.1739274225687269};
    const ModeTag d;
    const double length = part.to - part.from;
    const double per_interval = 2 / part.interval;
    std::array<double, node.size()> z;
    for (std::size_t i = 0; i < node.size(); ++i) {
        z[i] = part.from + length * node[i];
    }
    each_vector_of_modes(plate, [&](std::size_t first) HWY_ATTR {
        const std::size_t stride = plate.stride();
        std::array<ModeVec, moment_count> sums;
        for (std::size_t q = 0; q < sums.size(); ++q) {
            sums[q] = hn::LoadU(d, moments + q * stride + first);
        }
        const auto v = modes_at(plate, degree, first, z);
        for (std::size_t i = 0; i < node.size(); ++i) {
            const double x = 1 - per_interval * (part.line - z[i]);
            const ModeVec weighed = hn::Set(d, length * weight[i] * part.unit_s) * v[i];
            sums[0] = sums[0] + weighed;
            sums[1] = MulAdd(hn::Set(d, x), weighed, sums[1]);
            sums[2] = MulAdd(hn::Set(d, 0.5 * (3 * x * x - 1)), weighed, sums[2]);
            sums[3] = MulAdd(hn::Set(d, 0.5 * x * (5 * x * x - 3)), weighed, sums[3]);
        }
        for (std::size_t q = 0; q < sums.size(); ++q) {
            hn::StoreU(sums[q], d, moments + q * stride + first);
        }
    });
}

/// Sum of products of two stretches of numbers, a multiple of 16 long.
inline double sum_of_products(const double* a, const double* b, std::size_t count) {
    const Doubles d;
    Vec even = zero();
    Vec odd = zero();
    for (std::size_t i = 0; i < count; i += 2 * lanes()) {
        even = MulAdd(hn::LoadU(d, a + i), hn::LoadU(d, b + i), even);
        odd = MulAdd(hn::LoadU(d, a + i + lanes()), hn::LoadU(d, b + i + lanes()), odd);
    }
    return GetLane(hn::SumOfLanes(d, even + odd));
}

}  // namespace HWY_NAMESPACE
}  // namespace hertzline::kernels
HWY_AFTER_NAMESPACE();

#endif
