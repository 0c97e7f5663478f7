// Chin's algorithm while no contact switches. Included once per SIMD target.
#if defined(HERTZLINE_FROZEN_STEP_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HERTZLINE_FROZEN_STEP_INL
#undef HERTZLINE_FROZEN_STEP_INL
#else
#define HERTZLINE_FROZEN_STEP_INL
#endif

#include "core/integrators/chin4a/chin4a_chain-inl.hpp"
#include "core/integrators/simd/contact-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace hertzline::kernels {
namespace HWY_NAMESPACE {

inline constexpr double one_sixth = 1.0 / 6;
inline constexpr double two_thirds = 2.0 / 3;
/// Powers of the dashpots' decay over half a step that are kept: enough for the fourth order.
inline constexpr int drift_powers = 4;

/// A, on the next motion: exp of the linear dashpots on the velocities, its integral on the positions, as
/// Taylor series. The positions' series needs one power less for the same order; the forces wait for them, so
/// they are summed up as powers come.
template <std::size_t K>
HWY_INLINE void drift(Chin4aChain<K>& c, double time, const Decay<K>& decay) {
    using Scratch = typename Chin4aChain<K>::Scratch;
    Col<K> term = c.rows.scratch(Scratch::drift_term);
    Col<K> following = c.rows.scratch(Scratch::drift_following);
    HERTZLINE_EACH_ROW(k, c.rows.count()) {
        term.set(k, c.next.v[k]);
        c.next.x.set(k, MulAdd(splat(time), c.next.v[k], c.next.x[k]));
    }
    double factorial = 1;
    for (int power = 1; power <= drift_powers; ++power) {
        factorial *= power;
        const Vec velocity_weight = splat(1 / factorial);
        const Vec position_weight = splat(time * (1 / (factorial * (power + 1))));
        HERTZLINE_EACH_ROW(k, c.rows.count()) {
            const Vec own = decay.self[k] * term[k];
            const Vec with_right = MulAdd(decay.right[k], c.rows.right(term, k), own);
            following.set(k, MulAdd(decay.left[k], c.rows.left(term, k), with_right));
        }
        HERTZLINE_EACH_ROW(k, c.rows.count()) {
            term.set(k, following[k]);
            c.next.v.set(k, MulAdd(velocity_weight, following[k], c.next.v[k]));
            if (power < drift_powers) {
                c.next.x.set(k, MulAdd(position_weight, following[k], c.next.x[k]));
            }
        }
    }
}

/// Accelerations by all forces that depend on position and time alone.
template <std::size_t K>
HWY_INLINE void forces(Chin4aChain<K>& c, const Col<K>& x, Col<K>& a, Col<K>& overlap,
                       const HornMotion& horn) {
    Col<K> force = c.rows.scratch(Chin4aChain<K>::Scratch::force);
    HERTZLINE_EACH_ROW(k, c.rows.count()) {
        overlap.set(k, c.rows.difference(c.static_overlap[k], x, k, horn.x));
        const Vec root = Sqrt(pressed(overlap[k]));
        c.root_stiffness.set(k, c.closed_stiffness[k] * root);
        // the square root takes longest, so all else is done beside it; at rest the sum is exactly zero
        const Vec elastic = elastic_force(c.closed_stiffness[k], overlap[k], root);
        const Vec constant = k > 0 ? Neg(c.static_force[k])
                                   : MulSub(c.closed_damping[0], c.rows.horn(horn.v), c.static_force[0]);
        force.set(k, elastic + constant);
    }
    HERTZLINE_EACH_ROW(k, c.rows.count()) {
        const Vec constant = NegMulAdd(c.spring[k], x[k], c.bias[k]);
        const Vec net = force[k] - c.rows.right(force, k);
        a.set(k, MulAdd(c.inv_mass[k], net, c.inv_mass[k] * constant));
    }
}

/// 2/3 V~: accelerations a - h^2/24 M^-1 K_t a with the tangent stiffness 3/2 k sqrt(delta).
template <std::size_t K>
HWY_INLINE void kick_with_gradient(Chin4aChain<K>& c, double h) {
    Col<K> stretch = c.rows.scratch(Chin4aChain<K>::Scratch::stretch);
    HERTZLINE_EACH_ROW(k, c.rows.count()) {
        const Vec tangent = splat(1.5) * c.root_stiffness[k];
        stretch.set(k, tangent * c.rows.difference(c.next.a, k, 0));
    }
    const Vec time = splat(h * two_thirds);
    const Vec gradient_time = splat(h * h * h * (two_thirds / 24));
    HERTZLINE_EACH_ROW(k, c.rows.count()) {
        const Vec own = NegMulAdd(c.spring[k], c.next.a[k], stretch[k]);
        const Vec change = own - c.rows.right(stretch, k);
        const Vec without = MulAdd(time, c.next.a[k], c.next.v[k]);
        c.next.v.set(k, MulAdd(gradient_time * c.inv_mass[k], change, without));
    }
}

/// A clamped contact lets go while it is still pressed: the energy that it stores then is lost as it relaxes,
/// k delta^(3/2) |w|.
template <std::size_t K>
HWY_INLINE void add_let_go(const Chin4aChain<K>& c, std::size_t k, Vec w, Vec w_dot, Node<K>& node) {
    const Vec open = splat(1.0) - c.closed[k];
    const Vec stiffness = open * c.rows.load(ChainField::stiffness)[k];
    const Vec tangent = tangent_stiffness(stiffness, node.overlap[k]);
    const Vec force = elastic_force(stiffness, node.overlap[k]);
    node.loss.set(k, NegMulAdd(force, w, node.loss[k]));
    const Vec slope = MulAdd(tangent * w, w, force * w_dot);
    node.loss_dot.set(k, node.loss_dot[k] - slope);
}

/// Fills in a node from motion, overlap and the forces just computed. None of it feeds back into the motion.
template <std::size_t K>
HWY_INLINE void observe(const Chin4aChain<K>& c, const Motion<K>& motion, Node<K>& node,
                        const HornMotion& horn) {
    const Vec per_half = splat(c.per_half_step);
    HERTZLINE_EACH_ROW(k, c.rows.count()) {
        const Vec own = c.decay.self[k] * motion.v[k];
        const Vec with_right = MulAdd(c.decay.right[k], c.rows.right(motion.v, k), own);
        const Vec dashpots = MulAdd(c.decay.left[k], c.rows.left(motion.v, k), with_right);
        node.total_accel.set(k, MulAdd(per_half, dashpots, motion.a[k]));
    }
    node.held = node.held_dot = zero();
    if (HWY_UNLIKELY(c.rows.chain().holds)) {
        HERTZLINE_EACH_ROW(k, c.rows.count()) {
            const Vec force = c.drag[k] * motion.v[k];
            node.held = MulAdd(force, motion.v[k], node.held);
            node.held_dot = MulAdd(force + force, node.total_accel[k], node.held_dot);
        }
    }
    HERTZLINE_EACH_ROW(k, c.rows.count()) {
        const Vec w = c.rows.difference(motion.v, k, horn.v);
        const Vec w_dot = c.rows.difference(node.total_accel, k, horn.a);
        const Vec dashpot = c.closed_damping[k] * w;
        node.loss.set(k, dashpot * w);
        node.loss_dot.set(k, (dashpot + dashpot) * w_dot);
        if (HWY_UNLIKELY(c.tension == Tension::clamped)) {
            add_let_go(c, k, w, w_dot, node);
        }
        if (k == 0) {
            const Vec force = MulAdd(c.root_stiffness[0], pressed(node.overlap[0]), dashpot);
            const Vec tangent = splat(1.5) * c.root_stiffness[0];
            const Vec force_dot = MulAdd(tangent, w, c.closed_damping[0] * w_dot);
            node.work = force * c.rows.horn(horn.v);
            node.work_dot = MulAdd(force_dot, c.rows.horn(horn.v), force * c.rows.horn(horn.a));
        }
    }
}

/// V/6, A/2, 2V~/3, A/2, V/6 with the contacts as they are, from now to next.
/// @param half_drift A/2, on the next motion
template <std::size_t K, class HalfDrift>
HWY_INLINE void frozen_step(Chin4aChain<K>& c, double h, const HalfDrift& half_drift,
                            const HornMotion& middle, const HornMotion& end) {
    const Vec sixth = splat(h * one_sixth);
    HERTZLINE_EACH_ROW(k, c.rows.count()) {
        c.next.x.set(k, c.now.x[k]);
        c.next.v.set(k, MulAdd(sixth, c.now.a[k], c.now.v[k]));
    }
    half_drift(c);
    forces(c, c.next.x, c.next.a, c.next_node.overlap, middle);
    kick_with_gradient(c, h);
    half_drift(c);
    forces(c, c.next.x, c.next.a, c.next_node.overlap, end);
    HERTZLINE_EACH_ROW(k, c.rows.count()) c.next.v.set(k, MulAdd(sixth, c.next.a[k], c.next.v[k]));
    observe(c, c.next, c.next_node, end);
}

/// Next becomes now; the ledger takes the powers at both ends and their slopes (Hermite's rule).
template <std::size_t K>
HWY_INLINE void accept(Chin4aChain<K>& c, double h) {
    const Vec half = splat(0.5 * h);
    const Vec hermite = splat(h * h * (one_sixth / 2));
    HERTZLINE_EACH_ROW(k, c.rows.count()) {
        const Vec slopes = c.node.loss_dot[k] - c.next_node.loss_dot[k];
        const Vec mean = MulAdd(half, c.node.loss[k] + c.next_node.loss[k], hermite * slopes);
        c.lost.set(k, c.lost[k] + mean);
        c.peak.set(k, Max(c.peak[k], c.next_node.overlap[k]));
    }
    const Vec slopes = c.node.work_dot - c.next_node.work_dot;
    c.work.add(MulAdd(half, c.node.work + c.next_node.work, hermite * slopes));
    if (HWY_UNLIKELY(c.rows.chain().holds)) {
        const Vec held_slopes = c.node.held_dot - c.next_node.held_dot;
        const Vec held = MulAdd(half, c.node.held + c.next_node.held, hermite * held_slopes);
        c.rows.chain().held_lost += GetLane(hn::SumOfLanes(Doubles(), held));
    }
    c.node.held = c.next_node.held;
    c.node.held_dot = c.next_node.held_dot;
    c.rows.copy(c.now.x, c.next.x);
    c.rows.copy(c.now.v, c.next.v);
    c.rows.copy(c.now.a, c.next.a);
    c.rows.copy(c.node.overlap, c.next_node.overlap);
    c.rows.copy(c.node.total_accel, c.next_node.total_accel);
    c.rows.copy(c.node.loss, c.next_node.loss);
    c.rows.copy(c.node.loss_dot, c.next_node.loss_dot);
    c.node.work = c.next_node.work;
    c.node.work_dot = c.next_node.work_dot;
}

/// Computes again all that depends on the set of closed contacts: stiffnesses, dashpots, forces.
template <std::size_t K>
HWY_INLINE void rebuild(Chin4aChain<K>& c, const HornMotion& horn) {
    const Col<K> stiffness = c.rows.load(ChainField::stiffness);
    const Col<K> damping = c.rows.load(ChainField::damping);
    HERTZLINE_EACH_ROW(k, c.rows.count()) {
        c.closed_stiffness.set(k, c.closed[k] * stiffness[k]);
        c.closed_damping.set(k, c.closed[k] * damping[k]);
    }
    const Vec half = splat(0.5 * c.h);
    HERTZLINE_EACH_ROW(k, c.rows.count()) {
        const Vec mobility = half * c.inv_mass[k];
        c.decay.left.set(k, mobility * c.closed_damping[k]);
        c.decay.right.set(k, mobility * c.rows.right(c.closed_damping, k));
        const Vec held = mobility * c.drag[k];
        c.decay.self.set(k, Neg(c.decay.left[k] + c.decay.right[k] + held));
    }
    forces(c, c.now.x, c.now.a, c.node.overlap, horn);
    observe(c, c.now, c.node, horn);
}

}  // namespace HWY_NAMESPACE
}  // namespace hertzline::kernels
HWY_AFTER_NAMESPACE();

#endif
