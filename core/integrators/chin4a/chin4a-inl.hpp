// Chin's forward fourth-order algorithm 4A with located contacts.
//
//     V/6, A/2, 2V~/3, A/2, V/6        S. A. Chin, Phys. Lett. A 226 (1997) 344; time-dependent forces: S. A.
//     Chin and
//                                      C. R. Chen, astro-ph/0304223
//
// V kicks by the elastic forces, the plate's spring and the horn's part of the first dashpot, all functions
// of position and time. A drifts: positions by velocities, velocities by the dashpots, a linear flow that is
// exact up to its fifth power (the dashpots' decay over a step is small), which keeps the method fourth order
// with damping. V~ adds the force gradient h^2/48 grad |F|^2/m, which needs the tangent stiffness only. All
// coefficients are positive: no step backward.
//
// All this holds while the set of closed contacts stays what it is, so the set is frozen during a step. A
// step at whose end a contact is found on the wrong side is taken again up to the crossing, the contact is
// switched, and the rest of the step follows. The horn's motion is smooth only piecewise; where a piece ends
// inside a step the step is split, too.
#if defined(HERTZLINE_CHIN4A_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HERTZLINE_CHIN4A_INL
#undef HERTZLINE_CHIN4A_INL
#else
#define HERTZLINE_CHIN4A_INL
#endif

#include <algorithm>

#include "core/integrators/simd/lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace hertzline::kernels {
namespace HWY_NAMESPACE {

/// Displacement, velocity and elastic acceleration (carried over: the end of a step is the start of the
/// next).
template <std::size_t K>
struct Motion {
    Col<K> x, v, a;
};

/// What the end of a step tells besides the motion: contacts, and the power that the ledger integrates.
template <std::size_t K>
struct Node {
    Col<K> overlap;         ///< [m]
    Col<K> total_accel;     ///< with dashpots [m/s^2]
    Col<K> loss, loss_dot;  ///< lambda w^2 [W] and its slope [W/s]
    Vec work, work_dot;     ///< force on the horn times its velocity [W], slope [W/s]; lane 0
};

/// The horn over a part of a step, as the quintic through its motion at both ends (error 1e-11 of the
/// amplitude at 200 ns).
class HornCurve {
public:
    HornCurve(const HornMotion& from, const HornMotion& to, double duration)
        : duration_(duration), from_(from) {
        const double d = duration;
        const double x = to.x - from.x - d * (from.v + 0.5 * d * from.a);
        const double v = d * (to.v - from.v - d * from.a);
        const double a = d * d * (to.a - from.a);
        c3_ = 10 * x - 4 * v + 0.5 * a;
        c4_ = -15 * x + 7 * v - a;
        c5_ = 6 * x - 3 * v + 0.5 * a;
    }
    HornMotion at(double z) const {
        const double d = duration_;
        const double t = z * d;
        return {from_.x + t * (from_.v + 0.5 * t * from_.a) + z * z * z * (c3_ + z * (c4_ + z * c5_)),
                from_.v + t * from_.a + z * z * (3 * c3_ + z * (4 * c4_ + z * 5 * c5_)) / d,
                from_.a + z * (6 * c3_ + z * (12 * c4_ + z * 20 * c5_)) / (d * d)};
    }

private:
    double duration_;
    HornMotion from_;
    double c3_, c4_, c5_;
};

/// Whether a whole piece was already tried, and found to cross, before it is taken in parts.
enum class Trial { not_yet, crossed };

template <std::size_t K>
class Chin4a {
public:
    explicit HWY_INLINE Chin4a(SimdChain& chain)
        : fold_(chain),
          h_(chain.step_s),
          per_half_step_(2 / chain.step_s),
          tension_(chain.tension),
          static_overlap_(fold_.load(ChainField::static_overlap)),
          static_force_(fold_.load(ChainField::static_force)),
          inv_mass_(fold_.load(ChainField::inv_mass)),
          spring_(fold_.load(ChainField::spring)),
          bias_(fold_.load(ChainField::bias)),
          closed_(fold_.load(ChainField::closed)),
          peak_(fold_.load(ChainField::peak_overlap)),
          lost_(fold_.load(ChainField::lost)),
          work_(hn::Load(Doubles(), chain.column(ChainField::work))),
          stiffness_(fold_.load(ChainField::closed_stiffness)),
          damping_(fold_.load(ChainField::closed_damping)),
          from_left_(fold_.load(ChainField::from_left)),
          from_right_(fold_.load(ChainField::from_right)),
          from_self_(fold_.load(ChainField::from_self)),
          now_{fold_.load(ChainField::x), fold_.load(ChainField::v), fold_.load(ChainField::elastic_accel)},
          node_{fold_.load(ChainField::overlap),
                fold_.load(ChainField::total_accel),
                fold_.load(ChainField::loss_rate),
                fold_.load(ChainField::loss_rate_dot),
                hn::Load(Doubles(), chain.column(ChainField::work_rate)),
                hn::Load(Doubles(), chain.column(ChainField::work_rate_dot))},
          next_{fold_.load(ChainField::t0), fold_.load(ChainField::t1), fold_.load(ChainField::t2)},
          next_node_{fold_.load(ChainField::t3),
                     fold_.load(ChainField::t4),
                     fold_.load(ChainField::t5),
                     fold_.load(ChainField::t6),
                     hn::Zero(d_),
                     hn::Zero(d_)} {}

    HWY_INLINE void save() const {
        save_motion();
        fold_.store(ChainField::elastic_accel, now_.a);
        fold_.store(ChainField::closed, closed_);
        fold_.store(ChainField::peak_overlap, peak_);
        fold_.store(ChainField::lost, lost_);
        fold_.store(ChainField::closed_stiffness, stiffness_);
        fold_.store(ChainField::closed_damping, damping_);
        fold_.store(ChainField::from_left, from_left_);
        fold_.store(ChainField::from_right, from_right_);
        fold_.store(ChainField::from_self, from_self_);
        fold_.store(ChainField::overlap, node_.overlap);
        fold_.store(ChainField::loss_rate, node_.loss);
        fold_.store(ChainField::loss_rate_dot, node_.loss_dot);
        const SimdChain& chain = fold_.chain();
        hn::Store(work_, d_, chain.column(ChainField::work));
        hn::Store(node_.work, d_, chain.column(ChainField::work_rate));
        hn::Store(node_.work_dot, d_, chain.column(ChainField::work_rate_dot));
    }
    /// The step that try_step() found crossed: enough of it to tell where.
    HWY_INLINE void save_trial() const {
        fold_.store(ChainField::t0, next_.x);
        fold_.store(ChainField::t1, next_.v);
        fold_.store(ChainField::t3, next_node_.overlap);
    }
    /// What a trace is recorded from.
    HWY_INLINE void save_motion() const {
        fold_.store(ChainField::x, now_.x);
        fold_.store(ChainField::v, now_.v);
        fold_.store(ChainField::total_accel, node_.total_accel);
    }

    /// One step of a chain whose contacts stay as they are, from now to next.
    /// @returns whether they did; if not, next is void.
    HWY_INLINE bool try_step(const HornMotion& middle, const HornMotion& end) {
        return advance_to_next(h_, from_left_, from_right_, from_self_, middle, end);
    }

    HWY_INLINE void accept(double h) {
        const Vec half = hn::Set(d_, 0.5 * h);
        const Vec hermite = hn::Set(d_, h * h * (one_sixth / 2));
        HERTZLINE_EACH_ROW(k, fold_.rows()) {
            const Vec slopes = hn::Sub(node_.loss_dot[k], next_node_.loss_dot[k]);
            const Vec mean =
                hn::MulAdd(half, hn::Add(node_.loss[k], next_node_.loss[k]), hn::Mul(hermite, slopes));
            lost_.set(k, hn::Add(lost_[k], mean));
            peak_.set(k, hn::Max(peak_[k], next_node_.overlap[k]));
        }
        const Vec slopes = hn::Sub(node_.work_dot, next_node_.work_dot);
        work_ =
            hn::Add(work_, hn::MulAdd(half, hn::Add(node_.work, next_node_.work), hn::Mul(hermite, slopes)));
        fold_.copy(now_.x, next_.x);
        fold_.copy(now_.v, next_.v);
        fold_.copy(now_.a, next_.a);
        fold_.copy(node_.overlap, next_node_.overlap);
        fold_.copy(node_.total_accel, next_node_.total_accel);
        fold_.copy(node_.loss, next_node_.loss);
        fold_.copy(node_.loss_dot, next_node_.loss_dot);
        node_.work = next_node_.work;
        node_.work_dot = next_node_.work_dot;
    }

    /// Rebuilds what depends on the set of closed contacts: stiffnesses, dashpots, forces.
    HWY_INLINE void rebuild(const HornMotion& horn) {
        const Col<K> stiffness = fold_.load(ChainField::stiffness);
        const Col<K> damping = fold_.load(ChainField::damping);
        HERTZLINE_EACH_ROW(k, fold_.rows()) {
            stiffness_.set(k, hn::Mul(closed_[k], stiffness[k]));
            damping_.set(k, hn::Mul(closed_[k], damping[k]));
        }
        const Vec half = hn::Set(d_, 0.5 * h_);
        HERTZLINE_EACH_ROW(k, fold_.rows()) {
            const Vec mobility = hn::Mul(half, inv_mass_[k]);
            from_left_.set(k, hn::Mul(mobility, damping_[k]));
            from_right_.set(k, hn::Mul(mobility, fold_.right(damping_, k)));
            from_self_.set(k, hn::Neg(hn::Add(from_left_[k], from_right_[k])));
        }
        forces(now_.x, now_.a, node_.overlap, horn);
        observe(now_, node_, horn);
    }

    /// The horn's motion may jump where a piece of it begins: contact 0 is looked at anew. What a jump of the
    /// horn adds to the energy stored there is work.
    HWY_INLINE void meet_horn(const HornMotion& horn) {
        const Vec overlap = fold_.difference(static_overlap_[0], now_.x, 0, horn.x);
        const Vec gained = hn::Sub(stored(0, overlap), stored(0, node_.overlap[0]));
        work_ = hn::MulAdd(fold_.horn(1.0), gained, work_);
        const Vec w = fold_.difference(now_.v, 0, horn.v);
        const Vec touching = hn::IfThenElseZero(touches(0, overlap, w), hn::Set(d_, 1.0));
        const Vec changed = hn::Mul(fold_.horn(1.0), hn::Sub(touching, closed_[0]));
        fold_.chain().contact_events += hn::AllTrue(d_, hn::Eq(changed, hn::Zero(d_))) ? 0 : 1;
        closed_.set(0, hn::Add(closed_[0], changed));
    }

    /// A smooth piece of a step, the contacts' crossings located. `record_row` is called with the fraction of
    /// the piece before and after each switch.
    template <class RecordRow>
    HWY_INLINE void located(const HornCurve& horn, double duration, Trial trial, RecordRow&& record_row);

private:
    /// The frozen-contact step. Leaves the result in next_, next_node_.
    HWY_INLINE bool advance_to_next(double h, const Col<K>& from_left, const Col<K>& from_right,
                                    const Col<K>& from_self, const HornMotion& middle,
                                    const HornMotion& end) {
        const Vec sixth = hn::Set(d_, h * one_sixth);
        HERTZLINE_EACH_ROW(k, fold_.rows()) {
            next_.x.set(k, now_.x[k]);
            next_.v.set(k, hn::MulAdd(sixth, now_.a[k], now_.v[k]));
        }
        drift(0.5 * h, from_left, from_right, from_self);
        forces(next_.x, next_.a, next_node_.overlap, middle);
        kick_with_gradient(h);
        drift(0.5 * h, from_left, from_right, from_self);
        forces(next_.x, next_.a, next_node_.overlap, end);
        HERTZLINE_EACH_ROW(k, fold_.rows()) next_.v.set(k, hn::MulAdd(sixth, next_.a[k], next_.v[k]));
        observe(next_, next_node_, end);
        return hn::AllFalse(d_, any_crossing(end));
    }

    /// A: exp of the linear dashpots on the velocities, its integral on the positions, as Taylor series. The
    /// positions' series needs one power less for the same order; the forces wait for them, so they are
    /// summed up as powers come.
    HWY_INLINE void drift(double time, const Col<K>& from_left, const Col<K>& from_right,
                          const Col<K>& from_self) {
        Col<K> term = fold_.scratch(ChainField::t7);
        Col<K> following = fold_.scratch(ChainField::t8);
        HERTZLINE_EACH_ROW(k, fold_.rows()) {
            term.set(k, next_.v[k]);
            next_.x.set(k, hn::MulAdd(hn::Set(d_, time), next_.v[k], next_.x[k]));
        }
        double factorial = 1;
        for (int power = 1; power <= drift_powers; ++power) {
            factorial *= power;
            const Vec velocity_weight = hn::Set(d_, 1 / factorial);
            const Vec position_weight = hn::Set(d_, time * (1 / (factorial * (power + 1))));
            HERTZLINE_EACH_ROW(k, fold_.rows()) {
                const Vec own = hn::Mul(from_self[k], term[k]);
                const Vec with_right = hn::MulAdd(from_right[k], fold_.right(term, k), own);
                following.set(k, hn::MulAdd(from_left[k], fold_.left(term, k), with_right));
            }
            HERTZLINE_EACH_ROW(k, fold_.rows()) {
                term.set(k, following[k]);
                next_.v.set(k, hn::MulAdd(velocity_weight, following[k], next_.v[k]));
                if (power < drift_powers) {
                    next_.x.set(k, hn::MulAdd(position_weight, following[k], next_.x[k]));
                }
            }
        }
    }

    /// Accelerations by all forces that depend on position and time alone.
    HWY_INLINE void forces(const Col<K>& x, Col<K>& a, Col<K>& overlap, const HornMotion& horn) {
        Col<K> force = fold_.scratch(ChainField::t10);
        HERTZLINE_EACH_ROW(k, fold_.rows()) {
            overlap.set(k, fold_.difference(static_overlap_[k], x, k, horn.x));
            const Vec pushed = hn::Max(overlap[k], hn::Zero(d_));
            const Vec root = hn::Sqrt(pushed);
            root_stiffness_.set(k, hn::Mul(stiffness_[k], root));
            // the square root takes longest, so all else is done beside it; at rest the sum is exactly zero
            const Vec elastic = hn::Mul(hn::Mul(stiffness_[k], pushed), root);
            const Vec constant = k > 0 ? hn::Neg(static_force_[k])
                                       : hn::MulSub(damping_[0], fold_.horn(horn.v), static_force_[0]);
            force.set(k, hn::Add(elastic, constant));
        }
        HERTZLINE_EACH_ROW(k, fold_.rows()) {
            const Vec constant = hn::NegMulAdd(spring_[k], x[k], bias_[k]);
            const Vec net = hn::Sub(force[k], fold_.right(force, k));
            a.set(k, hn::MulAdd(inv_mass_[k], net, hn::Mul(inv_mass_[k], constant)));
        }
    }

    /// 2/3 V~: accelerations a - h^2/24 M^-1 K_t a with the tangent stiffness 3/2 k sqrt(delta).
    HWY_INLINE void kick_with_gradient(double h) {
        Col<K> stretch = fold_.scratch(ChainField::t10);
        HERTZLINE_EACH_ROW(k, fold_.rows()) {
            const Vec tangent = hn::Mul(hn::Set(d_, 1.5), root_stiffness_[k]);
            stretch.set(k, hn::Mul(tangent, fold_.difference(next_.a, k, 0)));
        }
        const Vec time = hn::Set(d_, h * two_thirds);
        const Vec gradient_time = hn::Set(d_, h * h * h * (two_thirds / 24));
        HERTZLINE_EACH_ROW(k, fold_.rows()) {
            const Vec own = hn::NegMulAdd(spring_[k], next_.a[k], stretch[k]);
            const Vec change = hn::Sub(own, fold_.right(stretch, k));
            const Vec without = hn::MulAdd(time, next_.a[k], next_.v[k]);
            next_.v.set(k, hn::MulAdd(hn::Mul(gradient_time, inv_mass_[k]), change, without));
        }
    }

    /// Fills in a node from motion, overlap and the forces just computed. None of it feeds back into the
    /// motion.
    HWY_INLINE void observe(const Motion<K>& motion, Node<K>& node, const HornMotion& horn) {
        const Vec per_half = hn::Set(d_, per_half_step_);
        HERTZLINE_EACH_ROW(k, fold_.rows()) {
            const Vec own = hn::Mul(from_self_[k], motion.v[k]);
            const Vec with_right = hn::MulAdd(from_right_[k], fold_.right(motion.v, k), own);
            const Vec dashpots = hn::MulAdd(from_left_[k], fold_.left(motion.v, k), with_right);
            node.total_accel.set(k, hn::MulAdd(per_half, dashpots, motion.a[k]));
        }
        HERTZLINE_EACH_ROW(k, fold_.rows()) {
            const Vec w = fold_.difference(motion.v, k, horn.v);
            const Vec w_dot = fold_.difference(node.total_accel, k, horn.a);
            const Vec dashpot = hn::Mul(damping_[k], w);
            node.loss.set(k, hn::Mul(dashpot, w));
            node.loss_dot.set(k, hn::Mul(hn::Add(dashpot, dashpot), w_dot));
            if (HWY_UNLIKELY(tension_ == Tension::clamped)) {
                add_let_go(k, w, w_dot, node);
            }
            if (k == 0) {
                const Vec pushed = hn::Max(node.overlap[0], hn::Zero(d_));
                const Vec force = hn::MulAdd(root_stiffness_[0], pushed, dashpot);
                const Vec tangent = hn::Mul(hn::Set(d_, 1.5), root_stiffness_[0]);
                const Vec force_dot = hn::MulAdd(tangent, w, hn::Mul(damping_[0], w_dot));
                node.work = hn::Mul(force, fold_.horn(horn.v));
                node.work_dot = hn::MulAdd(force_dot, fold_.horn(horn.v), hn::Mul(force, fold_.horn(horn.a)));
            }
        }
    }

    /// A clamped contact lets go while it is still pressed: what it stores then is lost as it relaxes, k
    /// delta^(3/2) |w|.
    HWY_INLINE void add_let_go(std::size_t k, Vec w, Vec w_dot, Node<K>& node) const {
        const Vec open = hn::Sub(hn::Set(d_, 1.0), closed_[k]);
        const Vec stiffness = hn::Mul(open, fold_.load(ChainField::stiffness)[k]);
        const Vec pushed = hn::Max(node.overlap[k], hn::Zero(d_));
        const Vec tangent = hn::Mul(hn::Mul(hn::Set(d_, 1.5), stiffness), hn::Sqrt(pushed));
        const Vec force = hn::Mul(hn::Mul(stiffness, pushed), hn::Sqrt(pushed));
        node.loss.set(k, hn::NegMulAdd(force, w, node.loss[k]));
        const Vec slope = hn::MulAdd(hn::Mul(tangent, w), w, hn::Mul(force, w_dot));
        node.loss_dot.set(k, hn::Sub(node.loss_dot[k], slope));
    }

    /// Elastic energy (2/5) k delta^(5/2) of contact k.
    HWY_INLINE Vec stored(std::size_t k, Vec overlap) const {
        const Vec pushed = hn::Max(overlap, hn::Zero(d_));
        const Vec force = hn::Mul(hn::Mul(fold_.load(ChainField::stiffness)[k], pushed), hn::Sqrt(pushed));
        return hn::Mul(hn::Mul(hn::Set(d_, 0.4), force), pushed);
    }

    /// Whether the contact law has contact k closed at an overlap [m] and a relative velocity [m/s].
    HWY_INLINE Flags touches(std::size_t k, Vec overlap, Vec w) const {
        const Flags overlapping = hn::Gt(overlap, hn::Zero(d_));
        if (HWY_LIKELY(tension_ == Tension::allowed)) {
            return overlapping;
        }
        // without tension a contact lets go as soon as dashpot and elasticity together would pull
        const Vec pushed = hn::Max(overlap, hn::Zero(d_));
        const Vec elastic = hn::Mul(hn::Mul(fold_.load(ChainField::stiffness)[k], pushed), hn::Sqrt(pushed));
        const Vec force = hn::MulAdd(fold_.load(ChainField::damping)[k], w, elastic);
        const Flags pad = hn::Eq(fold_.load(ChainField::stiffness)[k], hn::Zero(d_));
        return hn::Or(pad, hn::And(overlapping, hn::Gt(force, hn::Zero(d_))));
    }

    HWY_INLINE Flags crossing(std::size_t k, const HornMotion& end) const {
        const Vec w = fold_.difference(next_.v, k, end.v);
        return hn::Xor(touches(k, next_node_.overlap[k], w), hn::Gt(closed_[k], hn::Zero(d_)));
    }
    HWY_INLINE Flags any_crossing(const HornMotion& end) const {
        Flags any = crossing(0, end);
        HERTZLINE_EACH_ROW(k, fold_.rows()) any = hn::Or(any, crossing(k, end));
        return any;
    }

    HWY_INLINE Vec crossing_time(std::size_t k, double h, const HornMotion& begin,
                                 const HornMotion& end) const;

    static constexpr Doubles d_{};
    static constexpr int drift_powers = 4;
    static constexpr double one_sixth = 1.0 / 6;
    static constexpr double two_thirds = 2.0 / 3;

    Fold<K> fold_;
    double h_;
    double per_half_step_;
    Tension tension_;
    Col<K> static_overlap_, static_force_, inv_mass_, spring_, bias_;
    Col<K> closed_, peak_, lost_;
    Vec work_;
    Col<K> stiffness_, damping_;  // of the closed contacts
    Col<K> from_left_, from_right_,
        from_self_;  ///< dashpots' decay of a velocity over half a step, by neighbour
    Motion<K> now_;
    Node<K> node_;
    Motion<K> next_;
    Node<K> next_node_;
    Col<K> root_stiffness_ = fold_.scratch(ChainField::t11);  ///< k sqrt(delta) of the last forces()
};

/// Fraction of the step from now to next at which contact k crosses: root of the cubic through overlap and
/// relative velocity at both ends.
template <std::size_t K>
HWY_INLINE Vec Chin4a<K>::crossing_time(std::size_t k, double h, const HornMotion& begin,
                                        const HornMotion& end) const {
    const Vec zero = hn::Zero(d_);
    const Vec one = hn::Set(d_, 1.0);
    const Vec duration = hn::Set(d_, h);
    const Vec o0 = fold_.difference(static_overlap_[k], now_.x, k, begin.x);
    const Vec o1 = next_node_.overlap[k];
    const Vec w0 = hn::Mul(duration, fold_.difference(now_.v, k, begin.v));
    const Vec w1 = hn::Mul(duration, fold_.difference(next_.v, k, end.v));
    const Vec rise = hn::Sub(o1, o0);
    const Vec c2 = hn::Sub(hn::Sub(hn::Mul(hn::Set(d_, 3.0), rise), hn::Add(w0, w0)), w1);
    const Vec c3 = hn::Sub(hn::Add(w0, w1), hn::Add(rise, rise));
    const auto overlap = [&](Vec z)
                             HWY_ATTR { return hn::MulAdd(z, hn::MulAdd(z, hn::MulAdd(z, c3, c2), w0), o0); };
    const auto slope = [&](Vec z) HWY_ATTR {
        const Vec three_c3 = hn::Mul(hn::Set(d_, 3.0), c3);
        return hn::MulAdd(z, hn::MulAdd(z, three_c3, hn::Add(c2, c2)), w0);
    };
    const Flags closing = hn::Eq(closed_[k], zero);
    const bool law_is_overlap = tension_ == Tension::allowed;
    // Newton's method kept inside a bracket; the clamped law has no such simple slope and is bisected
    const int rounds = law_is_overlap ? 5 : 45;
    Vec low = zero;
    Vec high = one;
    Vec z = hn::Set(d_, 0.5);
    if (law_is_overlap) {
        const Vec secant = hn::Div(hn::Neg(o0), rise);
        z = hn::IfThenElse(hn::And(hn::Gt(secant, zero), hn::Lt(secant, one)), secant, z);
    }
    for (int i = 0; i < rounds; ++i) {
        const Vec o = overlap(z);
        const Vec w = slope(z);
        const Flags touching = touches(k, o, hn::Div(w, duration));
        const Flags crossed = hn::Not(hn::Xor(touching, closing));
        high = hn::IfThenElse(crossed, z, high);
        low = hn::IfThenElse(crossed, low, z);
        const Vec newton = hn::Sub(z, hn::Div(o, w));
        // the ends count as inside: a converged iterate stays where it is
        const Flags inside = hn::And(hn::Ge(newton, low), hn::Le(newton, high));
        const Vec halved = hn::Mul(hn::Set(d_, 0.5), hn::Add(low, high));
        z = law_is_overlap ? hn::IfThenElse(inside, newton, halved) : halved;
    }
    return law_is_overlap ? z : high;
}

template <std::size_t K>
template <class RecordRow>
HWY_INLINE void Chin4a<K>::located(const HornCurve& horn, double duration, Trial trial,
                                   RecordRow&& record_row) {
    constexpr double together = 1e-9;  // crossings closer than this [parts of the piece] are one
    Col<K> left = fold_.scratch(ChainField::t12);
    Col<K> right = fold_.scratch(ChainField::t13);
    Col<K> self = fold_.scratch(ChainField::t14);
    Col<K> times = fold_.scratch(ChainField::t15);
    double done = 0;
    // Contacts may chatter for ever in theory; after as many switches as a trace has room for the step is
    // taken as it is.
    for (int switches = 0;; ++switches) {
        const auto advance = [&](double part) HWY_ATTR {
            const Vec scale = hn::Set(d_, part * duration / h_);
            HERTZLINE_EACH_ROW(k, fold_.rows()) {
                left.set(k, hn::Mul(scale, from_left_[k]));
                right.set(k, hn::Mul(scale, from_right_[k]));
                self.set(k, hn::Mul(scale, from_self_[k]));
            }
            return advance_to_next(part * duration, left, right, self, horn.at(done + 0.5 * part),
                                   horn.at(done + part));
        };
        const double rest = 1 - done;
        const bool known_to_cross = trial == Trial::crossed && switches == 0;
        if (!known_to_cross && (advance(rest) || switches == max_switches)) {
            accept(rest * duration);
            return;
        }
        const HornMotion begin = horn.at(done);
        const HornMotion end = horn.at(1);
        Vec first = hn::Set(d_, 2.0);
        HERTZLINE_EACH_ROW(k, fold_.rows()) {
            const Vec time = crossing_time(k, rest * duration, begin, end);
            times.set(k, hn::IfThenElse(crossing(k, end), time, hn::Set(d_, 2.0)));
            first = hn::Min(first, times[k]);
        }
        const double part = hn::GetLane(hn::MinOfLanes(d_, first));
        if (part > together) {
            advance(part * rest);
            accept(part * rest * duration);
            done += part * rest;
        }
        record_row(done);
        std::size_t switched = 0;
        HERTZLINE_EACH_ROW(k, fold_.rows()) {
            const Flags now = hn::Le(times[k], hn::Set(d_, part + together));
            const Vec other = hn::Sub(hn::Set(d_, 1.0), closed_[k]);
            closed_.set(k, hn::IfThenElse(now, other, closed_[k]));
            switched += hn::CountTrue(d_, now);
        }
        fold_.chain().contact_events += static_cast<std::int64_t>(switched);
        rebuild(horn.at(done));
        record_row(done);
        if (1 - done <= together) {
            return;
        }
    }
}

/// A step in which a contact switches or the horn's motion has a break. Works from and to the chain's memory.
template <std::size_t K>
HWY_NOINLINE void take_split_step(SimdChain& chain, const ToneBurst& burst, const HornStep& horn,
                                  std::int64_t step, Trial trial, Trace& trace) {
    Chin4a<K> chin(chain);
    double from = 0;
    while (from < 1) {
        const double to = horn.breaks ? burst.next_break(step, from) : 1;
        const double inside = 0.5 * (from + to);
        const HornMotion begin = horn.breaks ? burst.at(step, from, inside) : horn.start;
        const HornMotion end = horn.breaks ? burst.at(step, to, inside) : horn.end;
        const auto record_row = [&](double fraction_of_piece) HWY_ATTR {
            if (trace.between && trace.count + 2 < trace.capacity) {
                chin.save_motion();
                record(chain, trace, step, from + fraction_of_piece * (to - from));
            }
        };
        if (horn.fresh || from > 0) {
            if (from > 0) {
                record_row(0);
            }
            chin.meet_horn(begin);
            chin.rebuild(begin);
            record_row(0);
        }
        const double duration = (to - from) * chain.step_s;
        chin.located(HornCurve(begin, end, duration), duration, trial, record_row);
        from = to;
    }
    chin.save();
}

template <std::size_t K>
int advance_chin4a(SimdChain& chain, const ToneBurst& burst, const HornStep* horn, std::int64_t first,
                   int count, Trace& trace) {
    Chin4a<K> chin(chain);
    if (chain.rebuild) {
        chin.rebuild(horn[0].start);
        chain.rebuild = false;
    }
    int taken = 0;
    while (taken < count && trace.has_room()) {
        const HornStep& now = horn[taken];
        const bool smooth = !now.fresh && !now.breaks;
        if (HWY_LIKELY(smooth && chin.try_step(now.middle, now.end))) {
            chin.accept(chain.step_s);
        } else {
            chin.save();
            chin.save_trial();
            take_split_step<K>(chain, burst, now, first + taken, smooth ? Trial::crossed : Trial::not_yet,
                               trace);
            chin = Chin4a<K>(chain);
        }
        ++taken;
        if (trace.next == first + taken) {
            chin.save_motion();
            record(chain, trace, first + taken, 0);
        }
    }
    chin.save();
    return taken;
}

}  // namespace HWY_NAMESPACE
}  // namespace hertzline::kernels
HWY_AFTER_NAMESPACE();

#endif
