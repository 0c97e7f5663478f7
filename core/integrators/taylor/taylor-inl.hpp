// Taylor series of the motion, with located contacts.
//
// Between openings and closings of contacts the motion is analytic. Its series about the present follows from
// the equations of motion order by order; that of Hertz's law u = delta^(3/2) from delta u' = 3/2 delta' u,
// so that no derivative is ever formed by hand:
//
//     n delta_0 u_n = sum_{j<n} (3/2 (n - j) - j) delta_{n-j} u_j
//
//     (the power rule for series, D. E. Knuth, The Art of Computer Programming 2, section 4.7; the method:
//     A. Jorba and M. Zou, Experimental Mathematics 14 (2005) 99)
//
// A piece is as long as its last coefficients allow; the series is its own dense output, for samples and for
// the moment at which a contact switches: there the piece ends, nothing is taken twice.
//
// Hertz's law has a branch point where a contact opens or closes. Before an opening the pieces shorten by
// themselves, since the coefficients tell how near it is. At a closing delta_0 = 0 and there is no series of
// delta^(3/2) in whole powers: for a first short piece the contact's dashpot is part of the expansion and
// its elastic force, k (w t)^(3/2) (1 + ...), is integrated term by term and added.
//
// Which contacts are closed is never remembered: at the start of a piece a contact is closed if it overlaps,
// or, within rounding of zero overlap, if it is closing.
#if defined(HERTZLINE_TAYLOR_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HERTZLINE_TAYLOR_INL
#undef HERTZLINE_TAYLOR_INL
#else
#define HERTZLINE_TAYLOR_INL
#endif

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <utility>

#include "core/integrators/series_piece.hpp"
#include "core/integrators/simd/lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace hertzline::kernels {
namespace HWY_NAMESPACE {

/// (a/b)^(numerator/denominator) within 6 %, from the bits of the exponents: enough for the length of a
/// piece.
HWY_INLINE double rough_power(double a, double b, std::int64_t numerator, std::int64_t denominator) {
    const std::int64_t exponent = std::bit_cast<std::int64_t>(a) - std::bit_cast<std::int64_t>(b);
    return std::bit_cast<double>(exponent / denominator * numerator + std::bit_cast<std::int64_t>(1.0));
}

/// Nodes and weights on [0, 1] by Gauss and Legendre (Abramowitz and Stegun, table 25.4): exact for the
/// products of two series up to twice their number of nodes.
template <int Degree>
struct Quadrature {
    static constexpr std::array<double, 5> node{0.046910077030668, 0.2307653449471585, 0.5,
                                                0.7692346550528415, 0.953089922969332};
    static constexpr std::array<double, 5> weight{0.1184634425280945, 0.2393143352496832, 0.2844444444444444,
                                                  0.2393143352496832, 0.1184634425280945};
};
template <>
struct Quadrature<13> {
    static constexpr std::array<double, 7> node{
        0.0254460438286207, 0.1292344072003028, 0.2970774243113014, 0.5,
        0.7029225756886986, 0.8707655927996972, 0.9745539561713793};
    static constexpr std::array<double, 7> weight{0.0647424830844348, 0.1398526957446384, 0.1909150252525595,
                                                  0.2089795918367347, 0.1909150252525595, 0.1398526957446384,
                                                  0.0647424830844348};
};

/// The horn's series where the piece begins.
HWY_INLINE void expand_horn(SeriesPiece& piece) {
    const Doubles d;
    const HornWaves& waves = piece.waves;
    for (std::size_t n = 0; n < HornWaves::pairs; n += hn::Lanes(d)) {
        Vec even = hn::Mul(hn::Set(d, waves.sine[0]), hn::LoadU(d, waves.even[0].data() + n));
        Vec odd = hn::Mul(hn::Set(d, waves.cosine[0]), hn::LoadU(d, waves.odd[0].data() + n));
        for (std::size_t i = 1; i < 3; ++i) {
            even = hn::MulAdd(hn::Set(d, waves.sine[i]), hn::LoadU(d, waves.even[i].data() + n), even);
            odd = hn::MulAdd(hn::Set(d, waves.cosine[i]), hn::LoadU(d, waves.odd[i].data() + n), odd);
        }
        hn::StoreInterleaved2(even, odd, d, piece.horn.data() + 2 * n);
    }
}

/// Sines and cosines at z, by the theorems of addition.
HWY_INLINE void turn_horn(HornWaves& waves, double z) {
    using Waves = hn::CappedTag<double, HornWaves::count>;
    constexpr Waves d;
    const auto zz = hn::Set(d, z);
    const auto square = hn::Mul(zz, zz);
    auto displacement = hn::Zero(d);
    auto slope = hn::Zero(d);
    for (std::size_t i = 0; i < HornWaves::count; i += hn::Lanes(d)) {
        auto even = hn::Load(d, waves.even_by_pair[HornWaves::pairs - 1].data() + i);
        auto odd = hn::Load(d, waves.odd_by_pair[HornWaves::pairs - 1].data() + i);
        for (std::size_t pair = HornWaves::pairs - 1; pair-- > 0;) {
            even = hn::MulAdd(even, square, hn::Load(d, waves.even_by_pair[pair].data() + i));
            odd = hn::MulAdd(odd, square, hn::Load(d, waves.odd_by_pair[pair].data() + i));
        }
        odd = hn::Mul(odd, zz);
        const auto sine = hn::Load(d, waves.sine.data() + i);
        const auto cosine = hn::Load(d, waves.cosine.data() + i);
        const auto later_sine = hn::MulAdd(sine, even, hn::Mul(cosine, odd));
        const auto later_cosine = hn::MulSub(cosine, even, hn::Mul(sine, odd));
        hn::Store(later_sine, d, waves.sine.data() + i);
        hn::Store(later_cosine, d, waves.cosine.data() + i);
        displacement = hn::Add(displacement, later_sine);
        slope = hn::MulAdd(later_cosine, hn::Load(d, waves.odd_by_pair[0].data() + i), slope);
    }
    waves.displacement = hn::GetLane(hn::SumOfLanes(d, displacement));
    waves.slope = hn::GetLane(hn::SumOfLanes(d, slope));
}

template <std::size_t K, int Degree>
class Taylor {
public:
    HWY_INLINE Taylor(SimdChain& chain, SeriesPiece& piece)
        : fold_(chain),
          piece_(piece),
          clamped_(chain.tension == Tension::clamped),
          square_(piece.unit_s * piece.unit_s),
          stiffness_(fold_.load(ChainField::stiffness)),
          static_force_(fold_.load(ChainField::static_force)),
          inv_mass_(fold_.load(ChainField::inv_mass)),
          spring_(fold_.load(ChainField::spring)),
          x_now_(fold_.load(ChainField::x)),
          v_now_(fold_.load(ChainField::v)) {
        if constexpr (K == 0) {
            for (int n = 0; n <= Degree; ++n) {
                x_[n] = {piece.displacement(n)};
                d_[n] = {piece.overlap(n)};
                u_[n] = {piece.elastic(n)};
            }
        }
    }

    HWY_INLINE void take() {
        if (!piece_.waves.silent) {
            expand_horn(piece_);
        }
        const bool onset = begin();
        orders(std::make_integer_sequence<int, Degree - 1>());
        double length = trusted_length(onset);
        move(length);
        // What happens rarely works on a copy: nothing that has its address taken stays in registers.
        if (HWY_UNLIKELY(clamped_)) {
            length = until_a_switch(Taylor(*this), length);
            move(length);
        }
        if (HWY_UNLIKELY(any_switch(length))) {
            length = clamped_ ? first_switch(Taylor(*this), length)
                              : first_crossing(Overlaps{fold_, d_, overlaps_, deflated_}, piece_.negligible,
                                               length);
            move(length);
        }
        if (HWY_UNLIKELY(onset)) {
            Taylor copy(*this);
            copy.add_onset_force(length);
            x_now_ = copy.x_now_;
            v_now_ = copy.v_now_;
        }
        if (piece_.keeps_ledger) {
            account(length);
        }
        if (!piece_.waves.silent && piece_.waves.turns) {
            turn_horn(piece_.waves, length);
        }
        piece_.length = length;
        save(length);
    }

private:
    // --- the series
    // -----------------------------------------------------------------------------------------

    template <int... N>
    HWY_INLINE void orders(std::integer_sequence<int, N...>) {
        (order<N>(), ...);
    }

    /// Orders 0 and 1 of displacements and overlaps; which contacts are closed; order 0 of the elastic
    /// forces. @returns whether a contact has just closed.
    HWY_INLINE bool begin() {
        const Vec unit = hn::Set(d_tag, piece_.unit_s);
        const Col<K> static_overlap = fold_.load(ChainField::static_overlap);
        const Col<K> damping = fold_.load(ChainField::damping);
        HERTZLINE_EACH_ROW(k, fold_.rows()) {
            x_[0].set(k, x_now_[k]);
            x_[1].set(k, hn::Mul(unit, v_now_[k]));
        }
        Flags any_onset = hn::Gt(hn::Zero(d_tag), hn::Zero(d_tag));
        HERTZLINE_EACH_ROW(k, fold_.rows()) {
            const Vec d1 = fold_.difference(x_[1], k, piece_.waves.slope);
            const Vec d0 = fold_.difference(static_overlap[k], x_[0], k, piece_.waves.displacement);
            const Vec hardly =
                hn::MulAdd(hn::Set(d_tag, at_zero), hn::Abs(d1), hn::Set(d_tag, piece_.negligible));
            const Flags touching_only = hn::Le(hn::Abs(d0), hardly);
            const Flags closing = hn::And(touching_only, hn::Gt(d1, hn::Set(d_tag, standstill)));
            d_[0].set(k, hn::IfThenZeroElse(touching_only, d0));
            d_[1].set(k, d1);
            const Flags overlaps = hn::Or(closing, hn::Gt(d_[0][k], hn::Zero(d_tag)));
            const Flags elastic = hn::AndNot(closing, overlaps);
            any_onset = hn::Or(any_onset, closing);
            onset_.set(k, hn::IfThenElseZero(closing, hn::Set(d_tag, 1.0)));
            deflated_.set(k, hn::IfThenElseZero(touching_only, hn::Set(d_tag, 1.0)));
            overlaps_.set(k, hn::IfThenElseZero(overlaps, hn::Set(d_tag, 1.0)));
            // root and quotient take long: they do not wait for what the contact is
            const Vec pressed = hn::Max(d0, hn::Set(d_tag, min_overlap));
            const Vec quotient = hn::Div(hn::Set(d_tag, 1.0), pressed);
            const Vec force = hn::Mul(hn::Mul(stiffness_[k], pressed), hn::Sqrt(pressed));
            per_overlap_.set(k, hn::IfThenElseZero(elastic, quotient));
            u_[0].set(k, hn::IfThenElseZero(elastic, force));  // [N] here, scaled below
        }
        HERTZLINE_EACH_ROW(k, fold_.rows()) {
            closed_.set(k, overlaps_[k]);
            if (HWY_UNLIKELY(clamped_)) {
                closed_.set(k, pushing(k, damping[k]));
            }
            decay_.set(k, hn::Mul(unit, hn::Mul(closed_[k], damping[k])));
            mobility_left_.set(k, fold_.left(inv_mass_, k));
            mobility_.set(k, hn::Add(inv_mass_[k], mobility_left_[k]));
            ground_.set(k, hn::Mul(hn::Set(d_tag, square_), fold_.left(spring_, k)));
        }
        const bool onset = !hn::AllFalse(d_tag, any_onset);
        piece_.onset = onset;
        return onset;
    }

    /// The forces of order N, and from them displacements and overlaps of order N + 2. Each order waits for
    /// the overlaps of the one before, so the way from these to the next ones is kept short.
    template <int N>
    HWY_INLINE void order() {
        Col<K> force = fold_.scratch(ChainField::t8);
        HERTZLINE_EACH_ROW(k, fold_.rows()) {
            const Vec of_place = place_share<N>(k);
            const Vec decay = hn::Mul(hn::Set(d_tag, 1.0 / (N + 2)), decay_[k]);
            force.set(k, hn::MulAdd(decay, d_[N + 1][k], of_place));
        }
        HERTZLINE_EACH_ROW(k, fold_.rows()) {
            const Vec right = fold_.right(force, k);
            x_[N + 2].set(k, hn::Mul(inv_mass_[k], hn::Sub(force[k], right)));
            const Vec horn = k == 0 ? fold_.horn(piece_.horn[N + 2]) : hn::Zero(d_tag);
            const Vec from_self = hn::NegMulAdd(mobility_[k], force[k], horn);
            const Vec from_right = hn::MulAdd(inv_mass_[k], right, from_self);
            d_[N + 2].set(k, hn::MulAdd(mobility_left_[k], fold_.left(force, k), from_right));
        }
        if constexpr (N == 0) {
            prepare_higher_orders();
        }
    }

    template <int N>
    HWY_INLINE Vec place_share(std::size_t k) {
        if constexpr (N == 0) {
            return first_force(k);
        } else {
            return hn::Mul(hn::Set(d_tag, 1.0 / ((N + 1) * (N + 2))), force_of_place<N>(k));
        }
    }

    /// Half the force of order 0, times unit^2, without the dashpots. The spring behind the last body is the
    /// force of a contact to its right, in the slot of a pad.
    HWY_INLINE Vec first_force(std::size_t k) const {
        const Vec half_square = hn::Set(d_tag, 0.5 * square_);
        const Vec elastic = HWY_UNLIKELY(clamped_) ? hn::Mul(closed_[k], u_[0][k]) : u_[0][k];
        const Vec bias = hn::Mul(half_square, fold_.left(fold_.load(ChainField::bias), k));
        const Vec half_ground = hn::Mul(hn::Set(d_tag, 0.5), ground_[k]);
        const Vec behind = hn::MulSub(half_ground, fold_.left(x_[0], k), bias);
        return hn::MulAdd(half_square, hn::Sub(elastic, static_force_[k]), behind);
    }

    HWY_INLINE void prepare_higher_orders() {
        const Vec square = hn::Set(d_tag, square_);
        HERTZLINE_EACH_ROW(k, fold_.rows()) {
            if (HWY_UNLIKELY(clamped_)) {
                settle_grazing_force(k);
            }
            u_[0].set(k, hn::Mul(square, u_[0][k]));
            elastic_slope_.set(k, hn::Mul(hn::Set(d_tag, 1.5), hn::Mul(u_[0][k], per_overlap_[k])));
        }
    }

    /// Order N of what depends on the overlap: elastic force, and spring behind the last body.
    template <int N>
    HWY_INLINE Vec force_of_place(std::size_t k) {
        const Vec bent = elastic_by_products<N>(k);
        u_[N].set(k, hn::MulAdd(elastic_slope_[k], d_[N][k], bent));
        if (HWY_UNLIKELY(clamped_)) {
            return hn::MulAdd(ground_[k], d_[N][k], hn::Mul(closed_[k], u_[N][k]));
        }
        return hn::MulAdd(hn::Add(ground_[k], elastic_slope_[k]), d_[N][k], bent);
    }

    /// The elastic force's coefficient of order N without the term of the overlap's.
    template <int N>
    HWY_INLINE Vec elastic_by_products(std::size_t k) const {
        if constexpr (N == 1) {
            return hn::Zero(d_tag);
        } else {
            return hn::Mul(products<N, 1>(k), per_overlap_[k]);
        }
    }
    /// Sum of the products with both orders at least J. The highest orders are known last: they are added
    /// last.
    template <int N, int J>
    HWY_INLINE Vec products(std::size_t k) const {
        if constexpr (2 * J > N) {
            return hn::Zero(d_tag);
        } else if constexpr (2 * J == N) {
            return with_product<N, J>(k, hn::Zero(d_tag));
        } else {
            return with_product<N, N - J>(k, with_product<N, J>(k, products<N, J + 1>(k)));
        }
    }
    template <int N, int J>
    HWY_INLINE Vec with_product(std::size_t k, Vec sum) const {
        constexpr double weight = (1.5 * (N - J) - J) / N;
        if constexpr (weight == 0) {
            return sum;
        } else {
            return hn::MulAdd(hn::Mul(hn::Set(d_tag, weight), u_[J][k]), d_[N - J][k], sum);
        }
    }

    // --- clamped tension: a contact lets go as soon as dashpot and elasticity together would pull
    // -------------

    /// 1 where a contact pushes at the piece's start, as far as the total force tells.
    HWY_INLINE Vec pushing(std::size_t k, Vec damping) {
        const Vec force = hn::MulAdd(damping, velocity_of_overlap(k), u_[0][k]);
        const Flags pushes = hn::And(hn::Gt(overlaps_[k], hn::Zero(d_tag)), hn::Gt(force, hn::Zero(d_tag)));
        const Flags pad = hn::Eq(stiffness_[k], hn::Zero(d_tag));
        return hn::IfThenElseZero(hn::Or(pad, pushes), hn::Set(d_tag, 1.0));
    }
    HWY_INLINE Vec velocity_of_overlap(std::size_t k) const {
        return hn::Mul(hn::Set(d_tag, piece_.per_unit), d_[1][k]);
    }
    /// Where the total force is zero within rounding its slope decides.
    HWY_INLINE void settle_grazing_force(std::size_t k) {
        const Vec zero = hn::Zero(d_tag);
        const Vec damping = hn::Mul(hn::Set(d_tag, piece_.per_unit), fold_.load(ChainField::damping)[k]);
        const Vec force = hn::MulAdd(damping, d_[1][k], u_[0][k]);
        const Vec elastic_slope =
            hn::Mul(hn::Mul(hn::Set(d_tag, 1.5), u_[0][k]), hn::Mul(per_overlap_[k], d_[1][k]));
        const Vec slope = hn::MulAdd(hn::Add(damping, damping), d_[2][k], elastic_slope);
        const Flags hardly = hn::Le(hn::Abs(force), hn::Mul(hn::Set(d_tag, at_zero), hn::Abs(slope)));
        const Flags undecided = hn::And(hn::And(hardly, hn::Gt(u_[0][k], zero)), hn::Gt(stiffness_[k], zero));
        const Vec decided = hn::IfThenElseZero(hn::Gt(slope, zero), hn::Set(d_tag, 1.0));
        closed_.set(k, hn::IfThenElse(undecided, decided, closed_[k]));
        decay_.set(k, hn::Mul(hn::Mul(closed_[k], damping), hn::Set(d_tag, square_)));
    }

    // --- how far it reaches
    // ---------------------------------------------------------------------------------

    HWY_INLINE double trusted_length(bool onset) {
        Vec last = hn::Zero(d_tag);
        HERTZLINE_EACH_ROW(k, fold_.rows()) {
            const Vec half_before = hn::Mul(hn::Set(d_tag, 0.5), hn::Abs(x_[Degree - 1][k]));
            last = hn::Max(last, hn::Max(hn::Abs(x_[Degree][k]), half_before));
        }
        piece_.largest = hn::GetLane(hn::MaxOfLanes(d_tag, last));
        const double error = Degree * piece_.largest + 1e-300;
        double length = rough_power(piece_.tolerance, error, 1, Degree - 1);
        if (HWY_UNLIKELY(onset)) {
            length = std::min(length, onset_length());
        }
        return std::min(piece_.reach, std::max(length, shortest));
    }

    /// A onset force is added without the chain's answer to it: short enough for that answer to stay below the
    /// tolerance, and for the overlap to grow steadily. Or no longer than it does not count at all.
    HWY_INLINE double onset_length() {
        Vec largest = hn::Zero(d_tag);
        Vec bent = hn::Zero(d_tag);
        Vec fastest = hn::Zero(d_tag);
        HERTZLINE_EACH_ROW(k, fold_.rows()) {
            const Vec w = hn::Mul(onset_[k], d_[1][k]);
            largest =
                hn::Max(largest, hn::Mul(hn::Mul(mobility_[k], stiffness_[k]), hn::Mul(w, hn::Sqrt(w))));
            const Vec per_w = hn::Div(onset_[k], hn::Max(d_[1][k], hn::Set(d_tag, standstill)));
            const Vec second = hn::Mul(hn::Abs(d_[2][k]), per_w);
            const Vec third = hn::Sqrt(hn::Mul(hn::Abs(d_[3][k]), per_w));
            bent = hn::Max(bent, hn::Max(second, third));
            fastest = hn::Max(fastest, w);
        }
        const double answer =
            0.4 * square_ * hn::GetLane(hn::MaxOfLanes(d_tag, largest)) * piece_.response + 1e-300;
        const double steady = 0.25 / (hn::GetLane(hn::MaxOfLanes(d_tag, bent)) + 0.25);
        const double length = std::min(rough_power(piece_.tolerance, answer, 2, 7), steady);
        if (hn::GetLane(hn::MaxOfLanes(d_tag, fastest)) > 1e3 * piece_.negligible) {
            return length;
        }
        const double without = negligible_length(Taylor(*this));
        if (without > length) {
            HERTZLINE_EACH_ROW(k, fold_.rows()) onset_.set(k, hn::Zero(d_tag));
        }
        return std::max(length, without);
    }
    /// A length during which contacts that have just closed overlap by no more than what counts.
    HWY_NOINLINE static double negligible_length(const Taylor& taylor) { return taylor.negligible_length(); }
    HWY_INLINE double negligible_length() const {
        double z = 1;
        for (int halvings = 0; halvings < 40; ++halvings, z /= 2) {
            Vec largest = hn::Zero(d_tag);
            HERTZLINE_EACH_ROW(k, fold_.rows()) {
                Vec sum = hn::Abs(d_[Degree][k]);
                for (int n = Degree - 1; n > 0; --n) {
                    sum = hn::MulAdd(sum, hn::Set(d_tag, z), hn::Abs(d_[n][k]));
                }
                largest = hn::Max(largest, hn::Mul(onset_[k], sum));
            }
            if (z * hn::GetLane(hn::MaxOfLanes(d_tag, largest)) <= piece_.negligible) {
                break;
            }
        }
        return z;
    }

    // --- its end
    // --------------------------------------------------------------------------------------------

    /// Displacement and velocity at z, to x_now_ and v_now_.
    HWY_INLINE void move(double z) {
        const Vec zz = hn::Set(d_tag, z);
        const Vec per_unit = hn::Set(d_tag, piece_.per_unit);
        const double half = z * z * z * z;
        const Vec power = hn::Set(d_tag, half * z);
        const Vec power_slope = hn::Set(d_tag, split * half);
        HERTZLINE_EACH_ROW(k, fold_.rows()) {
            // two halves, so that they can be worked on side by side
            Vec low = x_[split - 1][k];
            Vec low_slope = hn::Zero(d_tag);
            value_and_slope<split - 2, 0>(k, zz, low, low_slope);
            Vec high = x_[Degree][k];
            Vec high_slope = hn::Zero(d_tag);
            value_and_slope<Degree - 1, split>(k, zz, high, high_slope);
            x_now_.set(k, hn::MulAdd(power, high, low));
            const Vec slope = hn::MulAdd(power_slope, high, low_slope);
            v_now_.set(k, hn::Mul(per_unit, hn::MulAdd(power, high_slope, slope)));
        }
    }
    static constexpr int split = 5;
    template <int N, int Last>
    HWY_INLINE void value_and_slope(std::size_t k, Vec z, Vec& value, Vec& slope) const {
        slope = hn::MulAdd(slope, z, value);
        value = hn::MulAdd(value, z, x_[N][k]);
        if constexpr (N > Last) {
            value_and_slope<N - 1, Last>(k, z, value, slope);
        }
    }

    using Terms = std::array<Col<K>, Degree + 1>;
    template <int N, int Last = Degree>
    HWY_INLINE static Vec horner(const Terms& terms, std::size_t k, Vec z) {
        if constexpr (N == Last) {
            return terms[N][k];
        } else {
            return hn::MulAdd(horner<N + 1, Last>(terms, k, z), z, terms[N][k]);
        }
    }
    template <int N>
    HWY_INLINE static Vec horner_slope(const Terms& terms, std::size_t k, Vec z) {
        const Vec term = hn::Mul(hn::Set(d_tag, static_cast<double>(N)), terms[N][k]);
        if constexpr (N == Degree) {
            return term;
        } else {
            return hn::MulAdd(horner_slope<N + 1>(terms, k, z), z, term);
        }
    }
    HWY_INLINE static Vec value(const Terms& terms, std::size_t k, Vec z) { return horner<0>(terms, k, z); }
    HWY_INLINE static Vec slope(const Terms& terms, std::size_t k, Vec z) {
        return horner_slope<1>(terms, k, z);
    }

    // --- contacts that switch on the way
    // --------------------------------------------------------------------

    /// Whether contact k, were it closed, would push at z. Where dashpot and elasticity cancel to rounding it
    /// is what it was at the piece's start: contacts that graze on and on must not end one piece after
    /// another.
    HWY_INLINE Flags would_push(std::size_t k, Vec z) const {
        const Vec elastic = horner<0, Degree - 2>(u_, k, z);
        const Vec damping = hn::Mul(hn::Set(d_tag, piece_.unit_s), fold_.load(ChainField::damping)[k]);
        const Vec dashpot = hn::Mul(damping, slope(d_, k, z));
        const Vec parts = hn::Mul(hn::Set(d_tag, cancelled), hn::Add(hn::Abs(elastic), hn::Abs(dashpot)));
        const Vec velocity = hn::Mul(hn::Set(d_tag, rounding), hn::Abs(x_[1][k]));
        const Vec hardly = hn::MulAdd(damping, velocity, parts);
        const Vec of_closed = hn::Sub(hn::Set(d_tag, 1.0), hn::Add(closed_[k], closed_[k]));  // -1, else 1
        return hn::Gt(hn::Add(dashpot, elastic), hn::Mul(of_closed, hardly));
    }

    /// Contacts that are not at z what they are at the start.
    HWY_INLINE Flags switches(std::size_t k, Vec z) const {
        const Vec zero = hn::Zero(d_tag);
        const Vec limit = hn::IfThenElseZero(open(k), hn::Set(d_tag, piece_.negligible));
        const Flags overlaps = hn::Gt(value(d_, k, z), limit);
        Flags changed = hn::Xor(overlaps, hn::Gt(overlaps_[k], zero));
        if (HWY_UNLIKELY(clamped_)) {
            // what has just closed pushes; that its elastic force is not in the series does not matter
            const Flags onset = hn::Gt(onset_[k], zero);
            const Flags pad = hn::Eq(stiffness_[k], zero);
            const Flags pushes = hn::And(overlaps, hn::Or(onset, would_push(k, z)));
            changed = hn::Or(changed, hn::AndNot(pad, hn::Xor(pushes, hn::Gt(closed_[k], zero))));
        }
        return changed;
    }

    /// A contact without tension may let go and push again within a piece: an eighth of the length in which
    /// one does, or all of it.
    HWY_NOINLINE static double until_a_switch(const Taylor& taylor, double length) {
        return taylor.until_a_switch(length);
    }
    HWY_INLINE double until_a_switch(double length) const {
        constexpr int parts = 8;
        for (int part = 1; part < parts; ++part) {
            const double z = length * part / parts;
            HERTZLINE_EACH_ROW(k, fold_.rows()) {
                if (!hn::AllFalse(d_tag, switches(k, hn::Set(d_tag, z)))) {
                    return z;
                }
            }
        }
        return length;
    }

    HWY_INLINE bool any_switch(double length) const {
        const Vec z = hn::Set(d_tag, length);
        const Vec zero = hn::Zero(d_tag);
        Flags any = hn::Gt(zero, zero);
        Flags approach = any;
        HERTZLINE_EACH_ROW(k, fold_.rows()) {
            any = hn::Or(any, switches(k, z));
            approach = hn::Or(approach, hn::And(open(k), hn::Gt(d_[1][k], zero)));
        }
        if (!hn::AllFalse(d_tag, approach)) {
            // an open contact that approached and withdraws again may have touched in between
            HERTZLINE_EACH_ROW(k, fold_.rows()) {
                const Flags turned = hn::And(hn::Gt(d_[1][k], zero), hn::Lt(slope(d_, k, z), zero));
                any = hn::Or(any, hn::And(open(k), turned));
            }
        }
        return !hn::AllFalse(d_tag, any);
    }
    HWY_INLINE Flags open(std::size_t k) const { return hn::Eq(overlaps_[k], hn::Zero(d_tag)); }

    /// What tells when contacts close and open. A copy: nothing that has its address taken stays in
    /// registers.
    struct Overlaps {
        Fold<K> fold;
        Terms d;
        Col<K> overlaps;
        Col<K> deflated;
    };

    /// The first moment at which a contact opens or closes. Contacts that do so within the shortest piece do
    /// so together.
    HWY_NOINLINE static double first_crossing(const Overlaps& contacts, double negligible, double length) {
        Vec first = hn::Set(d_tag, length);
        HERTZLINE_EACH_ROW(k, contacts.fold.rows()) {
            const Flags open = hn::Eq(contacts.overlaps[k], hn::Zero(d_tag));
            const Vec end = turning_point(contacts.d, k, open, negligible, hn::Set(d_tag, length));
            const Vec limit = hn::IfThenElseZero(open, hn::Set(d_tag, negligible));
            const Flags changed = hn::Not(hn::Xor(open, hn::Gt(value(contacts.d, k, end), limit)));
            const Vec when = crossing(contacts, k, end, changed);
            first = hn::Min(first, hn::IfThenElse(changed, when, hn::Set(d_tag, length)));
        }
        return std::max(hn::GetLane(hn::MinOfLanes(d_tag, first)), shortest);
    }

    /// The same for contacts without tension, whose total force decides.
    HWY_NOINLINE static double first_switch(const Taylor& taylor, double length) {
        return taylor.first_switch(length);
    }
    HWY_INLINE double first_switch(double length) const {
        Vec first = hn::Set(d_tag, length);
        HERTZLINE_EACH_ROW(k, fold_.rows()) {
            const Vec end = turning_point(d_, k, open(k), piece_.negligible, hn::Set(d_tag, length));
            const Vec when = bisected(k, end);
            first = hn::Min(first, hn::IfThenElse(switches(k, end), when, hn::Set(d_tag, length)));
        }
        return std::max(hn::GetLane(hn::MinOfLanes(d_tag, first)), shortest);
    }

    /// Where an open contact that withdraws at `end` came nearest; `end` for all others and for those that
    /// did not touch then.
    HWY_INLINE static Vec turning_point(const Terms& d, std::size_t k, Flags open, double negligible,
                                        Vec end) {
        const Vec zero = hn::Zero(d_tag);
        const Vec limit = hn::Set(d_tag, negligible);
        const Flags apart = hn::Le(value(d, k, end), limit);
        const Flags turned = hn::And(hn::Gt(d[1][k], zero), hn::Lt(slope(d, k, end), zero));
        const Flags concerned = hn::And(hn::And(open, apart), turned);
        if (hn::AllFalse(d_tag, concerned)) {
            return end;
        }
        Vec low = zero;
        Vec high = end;
        for (int i = 0; i < bisections; ++i) {
            const Vec z = hn::Mul(hn::Set(d_tag, 0.5), hn::Add(low, high));
            const Flags approaching = hn::Gt(slope(d, k, z), zero);
            low = hn::IfThenElse(approaching, z, low);
            high = hn::IfThenElse(approaching, high, z);
        }
        const Flags touched = hn::And(concerned, hn::Gt(value(d, k, low), limit));
        return hn::IfThenElse(touched, low, end);
    }

    /// Root of the overlap between 0 and `end`, by Newton's method kept inside a bracket. A root at 0 itself,
    /// of a contact that has just switched, is divided out.
    HWY_INLINE static Vec crossing(const Overlaps& contacts, std::size_t k, Vec end, Flags wanted) {
        const Vec zero = hn::Zero(d_tag);
        const Vec one = hn::Set(d_tag, 1.0);
        const Flags deflated = hn::Gt(contacts.deflated[k], zero);
        std::array<Vec, Degree + 1> c;
        for (int n = 0; n < Degree; ++n) {
            c[n] = hn::IfThenElse(deflated, contacts.d[n + 1][k], contacts.d[n][k]);
        }
        c[Degree] = hn::IfThenZeroElse(deflated, contacts.d[Degree][k]);
        const auto evaluate = [&](Vec z, Vec& slope) HWY_ATTR {
            Vec value = c[Degree];
            slope = hn::Zero(d_tag);
            for (int n = Degree - 1; n >= 0; --n) {
                slope = hn::MulAdd(slope, z, value);
                value = hn::MulAdd(value, z, c[n]);
            }
            return value;
        };
        Vec slope;
        const Vec at_end = evaluate(end, slope);
        const Flags rising = hn::Gt(at_end, zero);
        // the cubic through both ends of the inverse function
        const Vec rise = hn::Sub(at_end, c[0]);
        const Vec t = hn::Div(hn::Neg(c[0]), rise);
        const Vec rest = hn::Sub(one, t);
        const Vec from = hn::Div(rise, hn::Mul(end, c[1]));
        const Vec to = hn::Div(rise, hn::Mul(end, slope));
        const Vec straight = hn::Mul(hn::Mul(t, t), hn::Sub(hn::Set(d_tag, 3.0), hn::Add(t, t)));
        const Vec bend = hn::Mul(hn::Mul(t, rest), hn::MulSub(from, rest, hn::Mul(to, t)));
        const Vec guess = hn::Add(straight, bend);
        const Flags sound = hn::And(hn::Gt(guess, zero), hn::Lt(guess, one));
        Vec z = hn::Mul(end, hn::IfThenElse(sound, guess, hn::Set(d_tag, 0.5)));
        Vec low = zero;
        Vec high = end;
        for (int i = 0; i < newton_rounds; ++i) {
            const Vec value = evaluate(z, slope);
            const Flags beyond = hn::Not(hn::Xor(hn::Gt(value, zero), rising));
            high = hn::IfThenElse(beyond, z, high);
            low = hn::IfThenElse(beyond, low, z);
            const Vec newton = hn::Sub(z, hn::Div(value, slope));
            // the ends count as inside: a converged iterate stays where it is
            const Flags inside = hn::And(hn::Ge(newton, low), hn::Le(newton, high));
            const Vec next = hn::IfThenElse(inside, newton, hn::Mul(hn::Set(d_tag, 0.5), hn::Add(low, high)));
            const Flags settled = hn::Le(hn::Abs(hn::Sub(next, z)), hn::Mul(hn::Set(d_tag, 1e-8), end));
            z = next;
            if (hn::AllTrue(d_tag, hn::Or(settled, hn::Not(wanted)))) {
                break;  // the error is the square of the last change
            }
        }
        return z;
    }

    /// The same by halving, for switches that have no simple slope.
    HWY_INLINE Vec bisected(std::size_t k, Vec end) const {
        Vec low = hn::Zero(d_tag);
        Vec high = end;
        for (int i = 0; i < bisections; ++i) {
            const Vec z = hn::Mul(hn::Set(d_tag, 0.5), hn::Add(low, high));
            const Flags beyond = switches(k, z);
            high = hn::IfThenElse(beyond, z, high);
            low = hn::IfThenElse(beyond, low, z);
        }
        return high;
    }

    /// Velocities and displacements by the elastic forces of contacts that have just closed:
    /// k (z g)^(3/2) with g = delta/z, g^(3/2) as a series, integrated twice.
    HWY_NOINLINE void add_onset_force(double z) {
        std::array<Col<K>, onset_terms> q;
        for (int n = 0; n < onset_terms; ++n) {
            q[n] = fold_.scratch(static_cast<ChainField>(static_cast<int>(ChainField::t11) + n));
        }
        HERTZLINE_EACH_ROW(k, fold_.rows()) {
            const Vec w = hn::IfThenElse(hn::Gt(onset_[k], hn::Zero(d_tag)), d_[1][k], hn::Set(d_tag, 1.0));
            const Vec scale = hn::Mul(hn::Mul(onset_[k], stiffness_[k]), hn::Set(d_tag, square_));
            q[0].set(k, hn::Mul(hn::Mul(scale, w), hn::Sqrt(w)));
            for (int n = 1; n < onset_terms; ++n) {
                Vec sum = hn::Zero(d_tag);
                for (int j = 0; j < n; ++j) {
                    const Vec weight = hn::Set(d_tag, (1.5 * (n - j) - j) / n);
                    sum = hn::MulAdd(hn::Mul(weight, q[j][k]), d_[n - j + 1][k], sum);
                }
                q[n].set(k, hn::Div(sum, w));
            }
        }
        double power = z * std::sqrt(z);  // z^(n + 3/2)
        for (int n = 0; n < onset_terms; ++n, power *= z) {
            const Vec for_v = hn::Set(d_tag, z * power / ((n + 2.5) * piece_.unit_s));
            const Vec for_x = hn::Set(d_tag, z * z * power / ((n + 2.5) * (n + 3.5)));
            HERTZLINE_EACH_ROW(k, fold_.rows()) {
                const Vec net = hn::Mul(inv_mass_[k], hn::Sub(q[n][k], fold_.right(q[n], k)));
                v_now_.set(k, hn::MulAdd(for_v, net, v_now_[k]));
                x_now_.set(k, hn::MulAdd(for_x, net, x_now_[k]));
                hn::Store(net, d_tag, piece_.onset_force(n) + k * hn::Lanes(d_tag));
            }
        }
    }

    // --- books
    // ----------------------------------------------------------------------------------------------

    /// What the dashpots lose and the horn gives over the piece.
    HWY_INLINE void account(double length) {
        const SimdChain& chain = fold_.chain();
        Col<K> lost = fold_.load(ChainField::lost);
        Vec work = hn::Load(d_tag, chain.column(ChainField::work));
        const Vec per_square = hn::Set(d_tag, 1 / square_);
        using Nodes = Quadrature<Degree>;
        for (std::size_t i = 0; i < Nodes::node.size(); ++i) {
            const Vec z = hn::Set(d_tag, length * Nodes::node[i]);
            const Vec weight = hn::Set(d_tag, length * Nodes::weight[i]);
            HERTZLINE_EACH_ROW(k, fold_.rows()) {
                const Vec w = slope(d_, k, z);                                   // [m]
                const Vec dashpot = hn::Mul(hn::Mul(decay_[k], per_square), w);  // [N]
                Vec loss = hn::Mul(dashpot, w);
                if (HWY_UNLIKELY(clamped_)) {
                    loss = hn::Sub(loss, hn::Mul(let_go(k, z), w));
                }
                lost.set(k, hn::MulAdd(weight, loss, lost[k]));
                if (k == 0) {
                    const Vec pressed = hn::Max(value(d_, 0, z), hn::Zero(d_tag));
                    const Vec elastic = hn::Mul(hn::Mul(stiffness_[0], pressed), hn::Sqrt(pressed));
                    const Vec force = hn::MulAdd(closed_[0], elastic, dashpot);
                    const Vec horn_velocity = hn::Mul(fold_.horn(1.0), hn::Add(w, slope(x_, 0, z)));
                    work = hn::MulAdd(hn::Mul(weight, force), horn_velocity, work);
                }
            }
        }
        fold_.store(ChainField::lost, lost);
        hn::Store(work, d_tag, chain.column(ChainField::work));
    }
    /// Elastic force that a contact without tension does not pass on: what it stores is lost as it relaxes.
    HWY_INLINE Vec let_go(std::size_t k, Vec z) const {
        const Vec pressed = hn::Max(value(d_, k, z), hn::Zero(d_tag));
        const Vec elastic = hn::Mul(hn::Mul(stiffness_[k], pressed), hn::Sqrt(pressed));
        return hn::Mul(hn::Sub(hn::Set(d_tag, 1.0), closed_[k]), elastic);
    }

    HWY_INLINE void save(double length) {
        const Vec z = hn::Set(d_tag, length);
        fold_.store(ChainField::x, x_now_);
        fold_.store(ChainField::v, v_now_);
        const Col<K> closed_before = fold_.load(ChainField::closed);
        std::size_t switched = 0;
        HERTZLINE_EACH_ROW(k, fold_.rows()) {
            switched += hn::CountTrue(d_tag, hn::Ne(closed_[k], closed_before[k]));
        }
        fold_.chain().contact_events += static_cast<std::int64_t>(switched);
        fold_.store(ChainField::closed, closed_);
        fold_.store(ChainField::overlap, overlaps_);
        Col<K> peak = fold_.load(ChainField::peak_overlap);
        HERTZLINE_EACH_ROW(k, fold_.rows()) peak.set(k, hn::Max(peak[k], value(d_, k, z)));
        fold_.store(ChainField::peak_overlap, peak);
        if constexpr (K > 0) {
            save_terms(std::make_integer_sequence<int, Degree + 1>());
        }
    }
    template <int... N>
    HWY_INLINE void save_terms(std::integer_sequence<int, N...>) {
        (save_term<N>(), ...);
    }
    template <int N>
    HWY_INLINE void save_term() {
        HERTZLINE_EACH_ROW(k, K) hn::Store(x_[N][k], d_tag, piece_.displacement(N) + k * hn::Lanes(d_tag));
    }

    static constexpr Doubles d_tag{};
    static constexpr double at_zero = 1e-7;        ///< overlap over its change in a unit that counts as none
    static constexpr double min_overlap = 1e-150;  ///< nothing above it overflows [m]
    static constexpr double standstill = 1e-60;    ///< change of overlap in a unit that counts as none [m]
    static constexpr double shortest = 1e-9;       ///< piece [z]: contacts that chatter cannot hold time back
    static constexpr double cancelled = 1e-13;     ///< of a force's parts: their sum counts as none
    static constexpr double rounding = 0x1p-51;    ///< of a difference of velocities, of the larger of both
    static constexpr int newton_rounds = 8;
    static constexpr int bisections = 45;

    Fold<K> fold_;
    SeriesPiece& piece_;
    bool clamped_;
    double square_;  ///< unit^2 [s^2]
    Col<K> stiffness_, static_force_, inv_mass_, spring_;
    Col<K> x_now_, v_now_;
    Terms x_, d_;  ///< displacements and overlaps [m]
    Terms u_;      ///< elastic forces times unit^2
    Col<K> closed_ = fold_.scratch(ChainField::t0);
    Col<K> overlaps_ = fold_.scratch(ChainField::t1);
    Col<K> onset_ = fold_.scratch(ChainField::t2);           ///< 1: closes at the piece's start
    Col<K> deflated_ = fold_.scratch(ChainField::t3);        ///< 1: its overlap is zero there
    Col<K> elastic_slope_ = fold_.scratch(ChainField::t10);  ///< 3/2 u_0/delta_0
    Col<K> mobility_ = fold_.scratch(ChainField::t4);        ///< of both bodies at a contact [1/kg]
    Col<K> mobility_left_ = fold_.scratch(ChainField::t7);
    Col<K> ground_ = fold_.scratch(ChainField::t9);       ///< spring behind the left body, times unit^2
    Col<K> per_overlap_ = fold_.scratch(ChainField::t5);  ///< 1/delta_0 [1/m]
    Col<K> decay_ = fold_.scratch(ChainField::t6);        ///< lambda of the closed contacts times unit
};

template <std::size_t K, int Degree>
void take_piece(SimdChain& chain, SeriesPiece& piece) {
    Taylor<K, Degree>(chain, piece).take();
}

}  // namespace HWY_NAMESPACE
}  // namespace hertzline::kernels
HWY_AFTER_NAMESPACE();

#endif
