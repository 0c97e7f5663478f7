// The losses of a modal plate's material. Included once per SIMD target.
#if defined(HERTZLINE_MODES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HERTZLINE_MODES_INL
#undef HERTZLINE_MODES_INL
#else
#define HERTZLINE_MODES_INL
#endif

#include <algorithm>
#include <array>

#include "core/integrators/plate_motion.hpp"
#include "core/integrators/taylor/plate-inl.hpp"
#include "core/simd/vectors-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace hertzline::kernels {
namespace HWY_NAMESPACE {

// Most plates have four modes or fewer.
using ModeTag = hn::CappedTag<double, 4>;
using ModeVec = hn::Vec<ModeTag>;

/// The derivatives of the modes' velocities by z at one end of a piece, in units of its length z: orders 0 to 3.
HWY_INLINE std::array<ModeVec, PlateMotion::mode_orders> modes_at_an_end(const PlateMotion& plate,
                                                                         const double* without_force,
                                                                         const double* force, double z,
                                                                         std::size_t first) {
    const ModeTag d;
    std::array<ModeVec, PlateMotion::mode_orders> ends;
    double power = 1;
    for (std::size_t k = 0; k < ends.size(); ++k, power *= z) {
        ModeVec sum = hn::Load(d, without_force + k * plate.stride() + first);
        for (std::size_t m = 0; m < k; ++m) {
            const ModeVec answer = hn::Load(d, plate.mode_answers() + (k - 1 - m) * plate.stride() + first);
            sum = MulAdd(hn::Set(d, force[m]), answer, sum);
        }
        ends[k] = hn::Set(d, power) * sum;
    }
    return ends;
}

/// Losses in the plate's material over the piece [J]: of the polynomial of degree 7 through the modes' velocities and their derivatives at
/// both ends. The states are at its end.
template <int Degree>
HWY_INLINE double losses(const PlateMotion& plate, double length) {
    constexpr std::size_t orders = PlateMotion::mode_orders;
    const ModeTag d;
    alignas(64) std::array<double, orders * PlateMotion::most_stride> now;
    double lost = 0;
    rows_times_states(plate, plate.mode_rows(), orders * plate.stride(), orders * plate.stride(), now.data());
    const auto force = force_at<Degree, orders - 1>(plate, length);
    for (std::size_t first = 0; first < plate.modes(); first += hn::Lanes(d)) {
        const auto from = modes_at_an_end(plate, plate.modes_before(), plate.force.data(), length, first);
        const auto to = modes_at_an_end(plate, now.data(), force.data(), length, first);
        std::array<ModeVec, 2 * orders> ends;
        std::copy(from.begin(), from.end(), ends.begin());
        std::copy(to.begin(), to.end(), ends.begin() + orders);
        ModeVec squares = hn::Zero(d);
        for (std::size_t i = 0; i < ends.size(); ++i) {
            ModeVec sum = hn::Zero(d);
            for (std::size_t j = 0; j < ends.size(); ++j) {
                sum = MulAdd(hn::Set(d, PlateMotion::products_of_ends()[i][j]), ends[j], sum);
            }
            squares = MulAdd(ends[i], sum, squares);
        }
        lost += GetLane(hn::SumOfLanes(d, squares * hn::Load(d, plate.mode_losses() + first)));
    }
    std::copy_n(now.data(), orders * plate.stride(), plate.modes_before());
    return length * lost;
}

}  // namespace HWY_NAMESPACE
}  // namespace hertzline::kernels
HWY_AFTER_NAMESPACE();

#endif
