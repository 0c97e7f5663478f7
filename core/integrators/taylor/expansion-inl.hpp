// A piece of the motion as power series in z, row by row, and their values. Included once per SIMD target.
#if defined(HERTZLINE_EXPANSION_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HERTZLINE_EXPANSION_INL
#undef HERTZLINE_EXPANSION_INL
#else
#define HERTZLINE_EXPANSION_INL
#endif

#include <array>
#include <cstddef>
#include <type_traits>
#include <variant>

#include "core/integrators/series_piece.hpp"
#include "core/integrators/simd/striped_rows-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace hertzline::kernels {
namespace HWY_NAMESPACE {

/// Coefficients of z^0 to z^Degree.
template <std::size_t K, int Degree>
using Series = std::array<Col<K>, Degree + 1>;

/// Overlap over its change in a unit that counts as none. Damping forces with a power of the overlap fall more slowly towards zero.
template <Damping Kind>
inline constexpr double at_zero = Kind == Damping::linear ? 1e-7 : 1e-9;
inline constexpr double standstill = 1e-60;  ///< change of overlap in a unit that counts as none [m]
inline constexpr double shortest = 1e-9;     ///< piece [z]: contacts that chatter cannot hold time back

/// The series of W (damping-inl.hpp); contacts with dashpots need none.
template <std::size_t K, int Degree, Damping Kind>
using DampingSeries = std::conditional_t<Kind == Damping::linear, std::monostate, Series<K, Degree>>;

template <std::size_t K, int Degree, Damping Kind>
struct Expansion {
    enum class Scratch {
        closed,
        overlaps,
        onset,
        deflated,
        elastic_slope,
        mobility,
        mobility_left,
        ground,
        per_overlap,
        decay,
        force,
        slowing,
        onset_term_0,
        onset_term_1,
        onset_term_2,
        onset_term_3,
        onset_term_4,
        count
    };

    HWY_INLINE Expansion(SimdChain& chain, SeriesPiece& given)
        : rows(chain),
          piece(given),
          clamped(chain.tension == Tension::clamped),
          held(chain.holds),
          square(given.unit_s * given.unit_s),
          stiffness(rows.load(ChainField::stiffness)),
          static_force(rows.load(ChainField::static_force)),
          inv_mass(rows.load(ChainField::inv_mass)),
          spring(rows.load(ChainField::spring)),
          x_now(rows.load(ChainField::x)),
          v_now(rows.load(ChainField::v)) {
        if constexpr (K == 0) {
            for (int n = 0; n <= Degree; ++n) {
                x[n] = {piece.displacement(n)};
                d[n] = {piece.overlap(n)};
                u[n] = {piece.elastic(n)};
                if constexpr (Kind == Damping::nonlinear) {
                    w[n] = {piece.damping(n)};
                }
            }
        }
    }

    HWY_INLINE Flags open(std::size_t k) const { return Eq(overlaps[k], zero()); }

    StripedRows<K> rows;
    SeriesPiece& piece;
    bool clamped;
    bool held;      ///< by a holder
    double square;  ///< unit^2 [s^2]
    Col<K> stiffness, static_force, inv_mass, spring;
    Col<K> x_now, v_now;

    Series<K, Degree> x, d;  ///< displacements and overlaps [m]
    Series<K, Degree> u;     ///< elastic forces times unit^2
    [[no_unique_address]] DampingSeries<K, Degree, Kind>
        w;  ///< W times unit: its slope is the damping force times unit^2

    // flags: 1 or 0
    Col<K> closed = rows.scratch(Scratch::closed);
    Col<K> overlaps = rows.scratch(Scratch::overlaps);
    Col<K> onset = rows.scratch(Scratch::onset);        ///< closes at the piece's start
    Col<K> deflated = rows.scratch(Scratch::deflated);  ///< its overlap is zero there

    Col<K> elastic_slope = rows.scratch(Scratch::elastic_slope);  ///< 3/2 u_0/delta_0
    Col<K> mobility = rows.scratch(Scratch::mobility);            ///< of both bodies at a contact [1/kg]
    Col<K> mobility_left = rows.scratch(Scratch::mobility_left);  ///< of the left one [1/kg]
    Col<K> ground = rows.scratch(Scratch::ground);            ///< spring behind the left body, times unit^2
    Col<K> per_overlap = rows.scratch(Scratch::per_overlap);  ///< 1/delta_0 [1/m]
    Col<K> decay = rows.scratch(Scratch::decay);  ///< D delta_0^q of the closed contacts times unit
    Vec handed = zero();                          ///< the last order of the force on a modal plate
};

/// A column's value in the first contact.
template <std::size_t K>
HWY_INLINE double in_first_contact(const Col<K>& column) {
    if constexpr (K == 0) {
        return column.rows[0];
    } else {
        return GetLane(column[0]);
    }
}

/// Value at z of terms N to Last, divided by z^N.
template <std::size_t N, std::size_t Last, std::size_t K, std::size_t Size>
HWY_INLINE Vec horner(const std::array<Col<K>, Size>& terms, std::size_t k, Vec z) {
    if constexpr (N == Last) {
        return terms[N][k];
    } else {
        return MulAdd(horner<N + 1, Last>(terms, k, z), z, terms[N][k]);
    }
}
template <std::size_t N, std::size_t K, std::size_t Size>
HWY_INLINE Vec horner_slope(const std::array<Col<K>, Size>& terms, std::size_t k, Vec z) {
    const Vec term = splat(static_cast<double>(N)) * terms[N][k];
    if constexpr (N + 1 == Size) {
        return term;
    } else {
        return MulAdd(horner_slope<N + 1>(terms, k, z), z, term);
    }
}

/// A series' value, and its slope, at z.
template <std::size_t K, std::size_t Size>
HWY_INLINE Vec value_at(const std::array<Col<K>, Size>& terms, std::size_t k, Vec z) {
    return horner<0, Size - 1>(terms, k, z);
}
template <std::size_t K, std::size_t Size>
HWY_INLINE Vec slope_at(const std::array<Col<K>, Size>& terms, std::size_t k, Vec z) {
    return horner_slope<1>(terms, k, z);
}

}  // namespace HWY_NAMESPACE
}  // namespace hertzline::kernels
HWY_AFTER_NAMESPACE();

#endif
