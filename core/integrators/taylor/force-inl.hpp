// The force of the last contact over a piece, as the outputs of a modal plate take it. Included once per SIMD target.
#if defined(HERTZLINE_FORCE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HERTZLINE_FORCE_INL
#undef HERTZLINE_FORCE_INL
#else
#define HERTZLINE_FORCE_INL
#endif

#include <array>
#include <cstddef>

#include "core/integrators/plate_motion.hpp"
#include "core/integrators/series_piece.hpp"
#include "core/plate/force_kernel.hpp"
#include "core/simd/vectors-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace hertzline::kernels {
namespace HWY_NAMESPACE {

// Gauss and Legendre with eight nodes on [0, 1] (Abramowitz and Stegun, table 25.4)
struct ForceNodes {
    static constexpr std::size_t count = 8;
    alignas(64) static constexpr std::array<double, count> node{
        0.0198550717512319, 0.1016667612931866, 0.2372337950418355, 0.4082826787521751,
        0.5917173212478249, 0.7627662049581645, 0.8983332387068134, 0.9801449282487681};
    alignas(64) static constexpr std::array<double, count> weight{
        0.0506142681451881, 0.1111905172266872, 0.1568533229389436, 0.1813418916891810,
        0.1813418916891810, 0.1568533229389436, 0.1111905172266872, 0.0506142681451881};
};

/// Weights of the force at the nodes in the moments of a whole interval, per length of it: [node][moment].
alignas(64) inline constexpr auto whole_interval = [] {
    std::array<double, ForceNodes::count * moment_stride> weights{};
    for (std::size_t i = 0; i < ForceNodes::count; ++i) {
        const double x = 2 * ForceNodes::node[i] - 1;
        double before = 1;
        double now = x;
        double* const row = weights.data() + i * moment_stride;
        row[0] = ForceNodes::weight[i];
        row[1] = ForceNodes::weight[i] * x;
        for (std::size_t q = 2; q < force_moments; ++q) {
            const auto n = static_cast<double>(q);
            const double next = ((2 * n - 1) * x * now - (n - 1) * before) / n;
            before = now;
            now = next;
            row[q] = ForceNodes::weight[i] * now;
        }
    }
    return weights;
}();

// Vectors of no more lanes than there are nodes, and moments with their padding.
using NodeTag = hn::CappedTag<double, ForceNodes::count>;
static_assert(ForceNodes::count == moment_stride);

/// The force's polynomial [N].
template <int Degree>
HWY_INLINE hn::Vec<NodeTag> smooth_force(const PlateMotion& plate, hn::Vec<NodeTag> z) {
    const NodeTag d;
    const auto square = z * z;
    auto even = hn::Set(d, plate.force_terms[Degree - 3]);
    auto odd = hn::Set(d, plate.force_terms[Degree - 2]);
    static_assert(Degree % 2 == 1);
    for (std::size_t m = Degree - 3; m > 0; m -= 2) {
        even = MulAdd(even, square, hn::Set(d, plate.force_terms[m - 2]));
        odd = MulAdd(odd, square, hn::Set(d, plate.force_terms[m - 1]));
    }
    return MulAdd(odd, z, even);
}

/// The moments of the force over an interval that lies in the piece as a whole, in which no contact has just closed.
template <int Degree>
void whole_interval_moments(const PlateMotion& plate, const ForceInterval& part, double* moments) {
    const NodeTag d;
    alignas(64) std::array<double, ForceNodes::count> force;
    for (std::size_t i = 0; i < ForceNodes::count; i += hn::Lanes(d)) {
        const auto z = MulAdd(hn::Set(d, part.interval), hn::Load(d, ForceNodes::node.data() + i),
                              hn::Set(d, part.from));
        hn::Store(hn::Set(d, part.interval * part.unit_s) * smooth_force<Degree>(plate, z), d,
                  force.data() + i);
    }
    for (std::size_t c = 0; c < moment_stride; c += hn::Lanes(d)) {
        auto even = hn::Zero(d);
        auto odd = hn::Zero(d);
        for (std::size_t i = 0; i < ForceNodes::count; i += 2) {
            even = MulAdd(hn::Set(d, force[i]), hn::Load(d, whole_interval.data() + i * moment_stride + c),
                          even);
            odd = MulAdd(hn::Set(d, force[i + 1]),
                         hn::Load(d, whole_interval.data() + (i + 1) * moment_stride + c), odd);
        }
        hn::StoreU(even + odd, d, moments + c);
    }
}

/// Adds the moments of the force over a part of an interval.
template <int Degree>
void add_force_moments(const PlateMotion& plate, const ForceInterval& part, double* moments) {
    const NodeTag d;
    const double length = part.to - part.from;
    std::array<decltype(hn::Zero(d)), force_moments> sums;
    sums.fill(hn::Zero(d));
    for (std::size_t i = 0; i < ForceNodes::count; i += hn::Lanes(d)) {
        const auto z =
            MulAdd(hn::Set(d, length), hn::Load(d, ForceNodes::node.data() + i), hn::Set(d, part.from));
        auto force = smooth_force<Degree>(plate, z);
        for (const OnsetForce& onset : plate.onset_forces) {
            alignas(64) std::array<double, ForceNodes::count> added;
            alignas(64) std::array<double, ForceNodes::count> places;
            hn::Store(z, d, places.data());
            for (std::size_t k = 0; k < hn::Lanes(d); ++k) {
                const double place = std::max(places[k], 0.0);
                double value = 0;
                for (int n = onset_terms; n-- > 0;) {
                    value = value * place + onset.term(n, plate.end_slot);
                }
                added[k] = onset.power(place) * value / (plate.mobility() * part.unit_s * part.unit_s);
            }
            force = force + hn::Load(d, added.data());
        }
        const auto weighed =
            hn::Set(d, length * part.unit_s) * hn::Load(d, ForceNodes::weight.data() + i) * force;
        const auto x = MulAdd(hn::Set(d, 2 / part.interval), z - hn::Set(d, part.line), hn::Set(d, 1.0));
        auto before = hn::Set(d, 1.0);
        auto now = x;
        sums[0] = sums[0] + weighed;
        sums[1] = MulAdd(now, weighed, sums[1]);
        for (std::size_t q = 2; q < force_moments; ++q) {
            const auto n = static_cast<double>(q);
            const auto next = hn::Set(d, (2 * n - 1) / n) * x * now - hn::Set(d, (n - 1) / n) * before;
            before = now;
            now = next;
            sums[q] = MulAdd(now, weighed, sums[q]);
        }
    }
    for (std::size_t q = 0; q < force_moments; ++q) {
        moments[q] += GetLane(hn::SumOfLanes(d, sums[q]));
    }
}

/// The states at the end of an interval.
inline void advance_states(const ForcedStates& states, const double* moments, const double* from,
                           double* to) {
    const Doubles d;
    const std::size_t size = states.size();
    for (std::size_t j = 0; j < size; j += lanes()) {
        const Vec turn_re = hn::LoadU(d, states.turn() + j);
        const Vec turn_im = hn::LoadU(d, states.turn() + size + j);
        const Vec from_re = hn::LoadU(d, from + j);
        const Vec from_im = hn::LoadU(d, from + size + j);
        Vec re = NegMulAdd(turn_im, from_im, turn_re * from_re);
        Vec im = MulAdd(turn_im, from_re, turn_re * from_im);
        for (std::size_t q = 0; q < force_moments; ++q) {
            const Vec moment = splat(moments[q]);
            re = MulAdd(moment, hn::LoadU(d, states.of_moment(q) + j), re);
            im = MulAdd(moment, hn::LoadU(d, states.of_moment(q) + size + j), im);
        }
        hn::StoreU(re, d, to + j);
        hn::StoreU(im, d, to + size + j);
    }
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
