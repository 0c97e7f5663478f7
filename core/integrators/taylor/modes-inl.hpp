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

}  // namespace HWY_NAMESPACE
}  // namespace hertzline::kernels
HWY_AFTER_NAMESPACE();

#endif
