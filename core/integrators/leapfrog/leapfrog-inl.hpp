// Leapfrog (drift, kick, drift) with fractional contact. Second order, symplectic for the elastic part.
//
// The dashpot's force jumps where a contact opens or closes. Taking the contact as open or closed for a whole
// step would leave any method first order; so each dashpot is weighed by the fraction of the step during
// which its contact is closed, as estimated from overlap and relative velocity at mid-step: clamp(1/2 +
// delta/(|w| h), 0, 1). The dashpots act at the mid-step velocity, predicted by half a kick (explicit
// midpoint rule).
#if defined(HERTZLINE_LEAPFROG_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HERTZLINE_LEAPFROG_INL
#undef HERTZLINE_LEAPFROG_INL
#else
#define HERTZLINE_LEAPFROG_INL
#endif

#include <limits>

#include "core/integrators/simd/contact-inl.hpp"
#include "core/integrators/simd/record-inl.hpp"
#include "core/integrators/simd/striped_rows-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace hertzline::kernels {
namespace HWY_NAMESPACE {

template <std::size_t K>
class Leapfrog {
public:
    explicit HWY_INLINE Leapfrog(SimdChain& chain)
        : rows_(chain),
          h_(chain.step_s),
          per_step_(1 / chain.step_s),
          lowest_(chain.tension == Tension::clamped ? 0.0 : -std::numeric_limits<double>::infinity()),
          stiffness_(rows_.load(ChainField::stiffness)),
          static_overlap_(rows_.load(ChainField::static_overlap)),
          static_force_(rows_.load(ChainField::static_force)),
          damping_(rows_.load(ChainField::damping)),
          inv_mass_(rows_.load(ChainField::inv_mass)),
          spring_(rows_.load(ChainField::spring)),
          drag_(rows_.load(ChainField::drag)),
          bias_(rows_.load(ChainField::bias)),
          x_(rows_.load(ChainField::x)),
          v_(rows_.load(ChainField::v)),
          closed_(rows_.load(ChainField::closed)),
          peak_(rows_.load(ChainField::peak_overlap)),
          lost_(rows_.load(ChainField::lost)),
          work_(chain),
          overlap_(rows_.scratch(Scratch::overlap)),
          elastic_(rows_.scratch(Scratch::elastic)),
          force_(rows_.scratch(Scratch::force)),
          middle_v_(rows_.scratch(Scratch::middle_v)) {}

    HWY_INLINE void step(const HornStep& horn) {
        drift(0.5 * h_);
        contacts(horn.middle);
        dashpots(v_, horn.middle);
        kick(v_, 0.5 * h_, middle_v_);
        dashpots(middle_v_, horn.middle);
        account(horn.middle);
        kick(middle_v_, h_, v_);
        drift(0.5 * h_);
    }

    /// Writes the motion and the ledger back to the chain.
    HWY_INLINE void save() const {
        save_motion();
        rows_.store(ChainField::closed, closed_);
        rows_.store(ChainField::peak_overlap, peak_);
        rows_.store(ChainField::lost, lost_);
        work_.save(rows_.chain());
    }
    HWY_INLINE void save_motion() const {
        rows_.store(ChainField::x, x_);
        rows_.store(ChainField::v, v_);
    }

    /// Accelerations at the end of a step, for samples between steps. Not part of the integration.
    HWY_INLINE void save_accelerations(const HornMotion& horn) {
        Col<K> a = rows_.scratch(Scratch::accel);
        HERTZLINE_EACH_ROW(k, rows_.count()) {
            const Vec overlap = rows_.difference(static_overlap_[k], x_, k, horn.x);
            const Vec dashpot = damping_[k] * rows_.difference(v_, k, horn.v);
            const Vec pulled = IfThenElseZero(Gt(overlap, zero()), dashpot);
            const Vec force = Max(elastic_force(stiffness_[k], overlap) + pulled, splat(lowest_));
            force_.set(k, force - static_force_[k]);
        }
        HERTZLINE_EACH_ROW(k, rows_.count()) a.set(k, acceleration(k, v_[k]));
        rows_.store(ChainField::total_accel, a);
    }

private:
    enum class Scratch { overlap, elastic, force, middle_v, accel, count };

    HWY_INLINE void drift(double time) {
        HERTZLINE_EACH_ROW(k, rows_.count()) x_.set(k, MulAdd(splat(time), v_[k], x_[k]));
    }

    /// Overlaps and elastic forces, relative to the static ones, at mid-step.
    HWY_INLINE void contacts(const HornMotion& horn) {
        HERTZLINE_EACH_ROW(k, rows_.count()) {
            const Vec overlap = rows_.difference(static_overlap_[k], x_, k, horn.x);
            overlap_.set(k, overlap);
            elastic_.set(k, elastic_force(stiffness_[k], overlap) - static_force_[k]);
        }
    }

    /// Total forces with dashpots driven by the velocities u: lambda w, weighed by the time in contact.
    HWY_INLINE void dashpots(const Col<K>& u, const HornMotion& horn) {
        const Vec per_step = splat(per_step_);
        HERTZLINE_EACH_ROW(k, rows_.count()) {
            const Vec w = rows_.difference(u, k, horn.v);
            const Vec weighed = weighed_by_contact(w, overlap_[k] * per_step);
            const Vec force = MulAdd(damping_[k], weighed, elastic_[k]);
            force_.set(k, Max(force, splat(lowest_) - static_force_[k]));
        }
    }

    /// @param v velocity of the bodies in their holder
    HWY_INLINE Vec acceleration(std::size_t k, Vec v) const {
        const Vec constant = NegMulAdd(drag_[k], v, NegMulAdd(spring_[k], x_[k], bias_[k]));
        const Vec net = force_[k] - rows_.right(force_, k);
        return inv_mass_[k] * (net + constant);
    }

    /// The velocities at the start become those after `time`. @param u velocities by which the holder slows
    HWY_INLINE void kick(const Col<K>& u, double time, Col<K>& result) const {
        HERTZLINE_EACH_ROW(k, rows_.count()) {
            result.set(k, MulAdd(splat(time), acceleration(k, u[k]), v_[k]));
        }
    }

    /// Ledger, contact events and peak overlaps; none of it feeds back into the motion.
    HWY_INLINE void account(const HornMotion& horn) {
        const Vec h = splat(h_);
        std::size_t events = 0;
        HERTZLINE_EACH_ROW(k, rows_.count()) {
            const Vec w = rows_.difference(middle_v_, k, horn.v);
            lost_.set(k, MulAdd(h * (force_[k] - elastic_[k]), w, lost_[k]));
            const Flags touching = Gt(overlap_[k], zero());
            const Flags touched = Gt(closed_[k], zero());
            events += CountTrue(Doubles(), Xor(touching, touched));
            closed_.set(k, one_where(touching));
            peak_.set(k, Max(peak_[k], overlap_[k]));
        }
        if (HWY_UNLIKELY(rows_.chain().holds)) {
            Vec held = zero();
            HERTZLINE_EACH_ROW(k, rows_.count()) held = MulAdd(drag_[k] * middle_v_[k], middle_v_[k], held);
            rows_.chain().held_lost += h_ * GetLane(hn::SumOfLanes(Doubles(), held));
        }
        work_.add(h * (force_[0] + static_force_[0]) * rows_.horn(horn.v));
        rows_.chain().contact_events += static_cast<std::int64_t>(events);
    }

    StripedRows<K> rows_;
    double h_;
    double per_step_;
    double lowest_;  ///< least total force of a contact [N]
    Col<K> stiffness_, static_overlap_, static_force_, damping_, inv_mass_, spring_, drag_, bias_;
    Col<K> x_, v_, closed_, peak_, lost_;
    HornWork work_;
    Col<K> overlap_, elastic_, force_, middle_v_;
};

template <std::size_t K>
int advance_leapfrog(SimdChain& chain, const Horn&, const HornStep* horn, std::int64_t first, int count,
                     Trace& trace) {
    Leapfrog<K> leapfrog(chain);
    int taken = 0;
    while (taken < count && trace.has_room()) {
        leapfrog.step(horn[taken]);
        ++taken;
        if (trace.between) {
            leapfrog.save_accelerations(horn[taken - 1].end);
        }
        if (trace.next == first + taken) {
            leapfrog.save_motion();
            record(chain, trace, first + taken, 0);
        }
    }
    leapfrog.save();
    return taken;
}

}  // namespace HWY_NAMESPACE
}  // namespace hertzline::kernels
HWY_AFTER_NAMESPACE();

#endif
