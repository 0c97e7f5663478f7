// A of Chin's algorithm over half a whole step, as one product with a band of coefficients: its terms wait for
// nothing but the velocities, while the powers of a series wait for each other. Included once per SIMD target.
#if defined(HERTZLINE_WHOLE_DRIFT_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HERTZLINE_WHOLE_DRIFT_INL
#undef HERTZLINE_WHOLE_DRIFT_INL
#else
#define HERTZLINE_WHOLE_DRIFT_INL
#endif

#include "core/integrators/chin4a/frozen_step-inl.hpp"

#define HERTZLINE_UNROLLED _Pragma("GCC unroll 16")

HWY_BEFORE_NAMESPACE();
namespace hertzline::kernels {
namespace HWY_NAMESPACE {

/// A matrix that couples a body with the `Reach` next ones on either side.
template <std::size_t K, int Reach>
struct Band {
    /// Coefficients of the velocities `distance` bodies to the right; below zero: to the left.
    HWY_INLINE Col<K>& at(int distance) { return diagonal[distance + Reach]; }
    HWY_INLINE const Col<K>& at(int distance) const { return diagonal[distance + Reach]; }
    Col<K> diagonal[2 * Reach + 1];
};

/// The drift() of half a step: exp of the dashpots' decay on velocities, and its integral on positions, up to the same powers.
/// Holds for one set of closed contacts. For chains in registers.
template <std::size_t K>
class WholeDrift {
public:
    explicit HWY_INLINE WholeDrift(const Chin4aChain<K>& c) {
        const double time = 0.5 * c.h;
        Band<K, reach> power;
        HERTZLINE_UNROLLED for (int d = -reach; d <= reach; ++d) {
            c.rows.fill(power.at(d), d == 0 ? 1.0 : 0.0);
            c.rows.copy(velocity_.at(d), power.at(d));
        }
        HERTZLINE_UNROLLED for (int d = -position_reach; d <= position_reach; ++d) {
            c.rows.fill(position_.at(d), d == 0 ? time : 0.0);
        }
        double factorial = 1;
        HERTZLINE_UNROLLED for (int n = 1; n <= reach; ++n) {
            factorial *= n;
            multiply(c, power, n);
            HERTZLINE_UNROLLED for (int d = -n; d <= n; ++d) {
                add(c, velocity_.at(d), 1 / factorial, power.at(d));
                if (n <= position_reach) {
                    add(c, position_.at(d), time / (factorial * (n + 1)), power.at(d));
                }
            }
        }
    }

    /// On the next motion.
    HWY_INLINE void operator()(Chin4aChain<K>& c) const {
        Col<K> left = c.next.v, right = c.next.v;
        Col<K> x_right, v_right;
        c.rows.fill(x_right, 0);
        c.rows.fill(v_right, 0);
        HERTZLINE_EACH_ROW(k, c.rows.count()) {
            c.next.x.set(k, MulAdd(position_.at(0)[k], c.next.v[k], c.next.x[k]));
            c.next.v.set(k, velocity_.at(0)[k] * c.next.v[k]);
        }
        HERTZLINE_UNROLLED for (int d = 1; d <= reach; ++d) {
            left = c.rows.shifted_up(left);
            right = c.rows.shifted_down(right);
            add_product(c, c.next.v, velocity_.at(-d), left);
            add_product(c, v_right, velocity_.at(d), right);
            if (d <= position_reach) {
                add_product(c, c.next.x, position_.at(-d), left);
                add_product(c, x_right, position_.at(d), right);
            }
        }
        HERTZLINE_EACH_ROW(k, c.rows.count()) {
            c.next.x.set(k, c.next.x[k] + x_right[k]);
            c.next.v.set(k, c.next.v[k] + v_right[k]);
        }
    }

private:
    static constexpr int reach = drift_powers;
    static constexpr int position_reach = drift_powers - 1;

    static HWY_INLINE void add(const Chin4aChain<K>& c, Col<K>& sum, double weight, const Col<K>& term) {
        HERTZLINE_EACH_ROW(k, c.rows.count()) sum.set(k, MulAdd(splat(weight), term[k], sum[k]));
    }

    static HWY_INLINE void add_product(const Chin4aChain<K>& c, Col<K>& sum, const Col<K>& factor,
                                       const Col<K>& term) {
        HERTZLINE_EACH_ROW(k, c.rows.count()) sum.set(k, MulAdd(factor[k], term[k], sum[k]));
    }

    /// power(n - 1) becomes power(n).
    static HWY_INLINE void multiply(const Chin4aChain<K>& c, Band<K, reach>& power, int n) {
        const Band<K, reach> before = power;
        HERTZLINE_UNROLLED for (int d = -n; d <= n; ++d) {
            HERTZLINE_EACH_ROW(k, c.rows.count()) {
                Vec sum = c.decay.self[k] * before.at(d)[k];
                if (d < n) {
                    sum = MulAdd(c.decay.left[k], c.rows.left(before.at(d + 1), k), sum);
                }
                if (d > -n) {
                    sum = MulAdd(c.decay.right[k], c.rows.right(before.at(d - 1), k), sum);
                }
                power.at(d).set(k, sum);
            }
        }
    }

    Band<K, reach> velocity_;
    Band<K, position_reach> position_;
};

/// A chain in memory has too many coefficients for the caches.
template <>
class WholeDrift<0> {
public:
    explicit HWY_INLINE WholeDrift(const Chin4aChain<0>& /*c*/) {}
    HWY_INLINE void operator()(Chin4aChain<0>& c) const { drift(c, 0.5 * c.h, c.decay); }
};

}  // namespace HWY_NAMESPACE
}  // namespace hertzline::kernels
HWY_AFTER_NAMESPACE();

#endif
