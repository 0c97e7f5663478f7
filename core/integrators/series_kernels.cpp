// One copy of the Taylor series per instruction set; the widest that this processor has is chosen at run time.

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/integrators/series_kernels.cpp"
#include "core/simd/simd_targets.hpp"
// before highway.h
#include <hwy/foreach_target.h>
// after foreach_target
#include <hwy/highway.h>

#include "core/integrators/taylor/force-inl.hpp"
#include "core/integrators/taylor/taylor-inl.hpp"
#include "core/simd/dispatch.hpp"

HWY_BEFORE_NAMESPACE();
namespace hertzline::kernels {
namespace HWY_NAMESPACE {

HWY_INLINE Vec moments(const SampleTimes& times, std::size_t i) {
    const Doubles d;
    const Vec number = hn::Iota(d, times.first_after_base + static_cast<double>(i));
    return hn::Mul(hn::Sub(number, hn::Set(d, times.fraction)), hn::Set(d, times.per_sample));
}

/// The first values of a vector, up to `count`, put down `stride` apart.
HWY_INLINE void put_down(Vec values, double* out, std::size_t count, std::size_t stride) {
    const Doubles d;
    if (stride == 1 && count >= hn::Lanes(d)) {
        hn::StoreU(values, d, out);
        return;
    }
    if (stride == 1) {
        hn::BlendedStore(values, hn::FirstN(d, count), d, out);
        return;
    }
    HWY_ALIGN std::array<double, hn::MaxLanes(Doubles())> all;
    hn::Store(values, d, all.data());
    for (std::size_t j = 0; j < std::min(count, hn::Lanes(d)); ++j) {
        out[j * stride] = all[j];
    }
}

/// Values of a polynomial, lowest term first, times a factor.
template <std::size_t Terms>
HWY_INLINE void sample_polynomial(const std::array<double, Terms>& terms, double factor,
                                  const SampleTimes& times, std::size_t count, double* out,
                                  std::size_t stride) {
    const Doubles d;
    for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
        const Vec z = moments(times, i);
        Vec sum = hn::Set(d, terms[Terms - 1]);
        for (std::size_t n = Terms - 1; n-- > 0;) {
            sum = hn::MulAdd(sum, z, hn::Set(d, terms[n]));
        }
        put_down(hn::Mul(hn::Set(d, factor), sum), out + i * stride, count - i, stride);
    }
}

/// A body's displacement or velocity.
template <int Degree>
void sample_body(const SeriesPiece& piece, std::size_t slot, bool velocities, SampleTimes times,
                 std::size_t count, double* out, std::size_t stride) {
    if (velocities) {
        std::array<double, Degree> slope;
        for (int n = 1; n <= Degree; ++n) {
            slope[n - 1] = n * piece.displacement(n)[slot];
        }
        sample_polynomial(slope, piece.per_unit, times, count, out, stride);
    } else {
        std::array<double, Degree + 1> terms;
        for (int n = 0; n <= Degree; ++n) {
            terms[n] = piece.displacement(n)[slot];
        }
        sample_polynomial(terms, 1, times, count, out, stride);
    }
}

/// Values of the polynomials of a vector of slots, times a factor: at each sample a vector, `stride` behind the one before.
template <std::size_t Terms>
HWY_INLINE void sample_vector(const std::array<Vec, Terms>& terms, double factor, const SampleTimes& times,
                              std::size_t count, double* out, std::size_t stride) {
    const Doubles d;
    constexpr std::size_t together =
        hn::MaxLanes(d) >= 8 ? 8 : 4;  // hide each other's latency; registers hold them
    for (std::size_t i = 0; i < count; i += together) {
        std::array<Vec, together> z;
        std::array<Vec, together> sums;
        for (std::size_t j = 0; j < together; ++j) {
            const double number = times.first_after_base + static_cast<double>(i + j);
            z[j] = hn::Set(d, (number - times.fraction) * times.per_sample);
            sums[j] = terms[Terms - 1];
        }
        for (std::size_t n = Terms - 1; n-- > 0;) {
            for (std::size_t j = 0; j < together; ++j) {
                sums[j] = hn::MulAdd(sums[j], z[j], terms[n]);
            }
        }
        for (std::size_t j = 0; j < std::min(together, count - i); ++j) {
            hn::StoreU(hn::Mul(hn::Set(d, factor), sums[j]), d, out + (i + j) * stride);
        }
    }
}

/// Samples all slots, with the same bits as sample_body().
template <int Degree>
void sample_slots(const SeriesPiece& piece, std::size_t slots, bool velocities, SampleTimes times,
                  std::size_t count, double* out) {
    const Doubles d;
    for (std::size_t slot = 0; slot < slots; slot += hn::Lanes(d)) {
        if (velocities) {
            std::array<Vec, Degree> slope;
            for (int n = 1; n <= Degree; ++n) {
                slope[n - 1] = hn::Mul(hn::Set(d, n), hn::Load(d, piece.displacement(n) + slot));
            }
            sample_vector(slope, piece.per_unit, times, count, out + slot, slots);
        } else {
            std::array<Vec, Degree + 1> terms;
            for (int n = 0; n <= Degree; ++n) {
                terms[n] = hn::Load(d, piece.displacement(n) + slot);
            }
            sample_vector(terms, 1, times, count, out + slot, slots);
        }
    }
}

/// A polynomial of no more terms than a body's velocity has.
template <int Degree>
void sample_velocity(const std::array<double, most_series_terms>& terms, SampleTimes times, std::size_t count,
                     double* out) {
    std::array<double, Degree> used;
    std::copy_n(terms.begin(), used.size(), used.begin());
    sample_polynomial(used, 1, times, count, out, 1);
}

template <int Degree, Damping Kind>
SeriesKernels for_rows(std::size_t rows) {
    auto piece = take_piece<0, Degree, Kind>;
    if constexpr (hn::MaxLanes(Doubles()) > 1) {  // else a row is one body
        piece = rows == 1 ? take_piece<1, Degree, Kind> : rows == 2 ? take_piece<2, Degree, Kind> : piece;
    }
    return {piece,
            sample_body<Degree>,
            sample_slots<Degree>,
            sample_velocity<Degree>,
            add_force_moments<Degree>,
            whole_interval_moments<Degree>,
            advance_states,
            sum_of_products};
}

/// Every series in the table of integrators has its kernels.
template <std::size_t Row>
SeriesKernels for_series(Integrator integrator, std::size_t rows, Damping damping) {
    if constexpr (Row == methods.size()) {
        return {};  // a grid: grid_kernels.cpp
    } else {
        if constexpr (methods[Row].family == Family::series) {
            if (integrator == methods[Row].integrator) {
                constexpr int degree = series_degree(methods[Row].integrator);
                return damping == Damping::linear ? for_rows<degree, Damping::linear>(rows)
                                                  : for_rows<degree, Damping::nonlinear>(rows);
            }
        }
        return for_series<Row + 1>(integrator, rows, damping);
    }
}

SeriesKernels pick_series(Integrator integrator, std::size_t rows, Damping damping) {
    return for_series<0>(integrator, rows, damping);
}

}  // namespace HWY_NAMESPACE
}  // namespace hertzline::kernels
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hertzline::kernels {

HERTZLINE_EXPORT(pick_series);

SeriesKernels series_kernels(Integrator integrator, std::size_t rows, DampingLaw law) noexcept {
    return HERTZLINE_DISPATCH(pick_series)(integrator, rows, damping_of(law));
}

}  // namespace hertzline::kernels
#endif
