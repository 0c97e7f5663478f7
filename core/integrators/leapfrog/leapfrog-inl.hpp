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

#include "core/integrators/simd/lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace hertzline::kernels {
namespace HWY_NAMESPACE {

template <std::size_t K>
class Leapfrog {
public:
    explicit HWY_INLINE Leapfrog(SimdChain& chain)
        : fold_(chain),
          h_(chain.step_s),
          per_step_(1 / chain.step_s),
          lowest_(chain.tension == Tension::clamped ? 0.0 : -std::numeric_limits<double>::infinity()),
          stiffness_(fold_.load(ChainField::stiffness)),
          static_overlap_(fold_.load(ChainField::static_overlap)),
          static_force_(fold_.load(ChainField::static_force)),
          damping_(fold_.load(ChainField::damping)),
          inv_mass_(fold_.load(ChainField::inv_mass)),
          spring_(fold_.load(ChainField::spring)),
          bias_(fold_.load(ChainField::bias)),
          x_(fold_.load(ChainField::x)),
          v_(fold_.load(ChainField::v)),
          closed_(fold_.load(ChainField::closed)),
          peak_(fold_.load(ChainField::peak_overlap)),
          lost_(fold_.load(ChainField::lost)),
          work_(hn::Load(Doubles(), chain.column(ChainField::work))),
          overlap_(fold_.scratch(ChainField::t0)),
          elastic_(fold_.scratch(ChainField::t1)),
          force_(fold_.scratch(ChainField::t2)),
          middle_v_(fold_.scratch(ChainField::t3)) {}

    HWY_INLINE void step(const HornStep& horn) {
        drift(0.5 * h_);
        contacts(horn.middle);
        dashpots(v_, horn.middle);
        kick(middle_v_, 0.5 * h_);
        dashpots(middle_v_, horn.middle);
        account(horn.middle);
        kick(v_, h_);
        drift(0.5 * h_);
    }

    /// Writes what moved back to the chain.
    HWY_INLINE void save() const {
        save_motion();
        fold_.store(ChainField::closed, closed_);
        fold_.store(ChainField::peak_overlap, peak_);
        fold_.store(ChainField::lost, lost_);
        hn::Store(work_, Doubles(), fold_.chain().column(ChainField::work));
    }
    HWY_INLINE void save_motion() const {
        fold_.store(ChainField::x, x_);
        fold_.store(ChainField::v, v_);
    }

    /// Accelerations at the end of a step, for samples between steps. Not part of the integration.
    HWY_INLINE void save_accelerations(const HornMotion& horn) {
        Col<K> a = fold_.scratch(ChainField::t4);
        HERTZLINE_EACH_ROW(k, fold_.rows()) {
            const Vec overlap = fold_.difference(static_overlap_[k], x_, k, horn.x);
            const Vec dashpot = hn::Mul(damping_[k], fold_.difference(v_, k, horn.v));
            const Vec pulled = hn::IfThenElseZero(hn::Gt(overlap, hn::Zero(d_)), dashpot);
            const Vec pushed = hn::Max(overlap, hn::Zero(d_));
            const Vec elastic = hn::Mul(hn::Mul(stiffness_[k], pushed), hn::Sqrt(pushed));
            const Vec force = hn::Max(hn::Add(elastic, pulled), hn::Set(d_, lowest_));
            force_.set(k, hn::Sub(force, static_force_[k]));
        }
        HERTZLINE_EACH_ROW(k, fold_.rows()) a.set(k, acceleration(k));
        fold_.store(ChainField::total_accel, a);
    }

private:
    HWY_INLINE void drift(double time) {
        HERTZLINE_EACH_ROW(k, fold_.rows()) x_.set(k, hn::MulAdd(hn::Set(d_, time), v_[k], x_[k]));
    }

    /// Overlaps and elastic forces, relative to the static ones, at mid-step.
    HWY_INLINE void contacts(const HornMotion& horn) {
        HERTZLINE_EACH_ROW(k, fold_.rows()) {
            const Vec overlap = fold_.difference(static_overlap_[k], x_, k, horn.x);
            const Vec pushed = hn::Max(overlap, hn::Zero(d_));
            const Vec force = hn::Mul(hn::Mul(stiffness_[k], pushed), hn::Sqrt(pushed));
            overlap_.set(k, overlap);
            elastic_.set(k, hn::Sub(force, static_force_[k]));
        }
    }

    /// Total forces with dashpots driven by the velocities u: lambda w, weighed by the time in contact.
    HWY_INLINE void dashpots(const Col<K>& u, const HornMotion& horn) {
        const Vec per_step = hn::Set(d_, per_step_);
        HERTZLINE_EACH_ROW(k, fold_.rows()) {
            const Vec w = fold_.difference(u, k, horn.v);
            const Vec speed = hn::Abs(w);
            const Vec in_contact = hn::MulAdd(hn::Set(d_, 0.5), speed, hn::Mul(overlap_[k], per_step));
            const Vec weighed = hn::Min(hn::Max(in_contact, hn::Zero(d_)), speed);
            const Vec force = hn::MulAdd(damping_[k], hn::CopySignToAbs(weighed, w), elastic_[k]);
            force_.set(k, hn::Max(force, hn::Sub(hn::Set(d_, lowest_), static_force_[k])));
        }
    }

    HWY_INLINE Vec acceleration(std::size_t k) const {
        const Vec constant = hn::NegMulAdd(spring_[k], x_[k], bias_[k]);
        const Vec net = hn::Sub(force_[k], fold_.right(force_, k));
        return hn::Mul(inv_mass_[k], hn::Add(net, constant));
    }

    HWY_INLINE void kick(Col<K>& result, double time) const {
        HERTZLINE_EACH_ROW(k, fold_.rows())
        result.set(k, hn::MulAdd(hn::Set(d_, time), acceleration(k), v_[k]));
    }

    /// Ledger, contact events and peak overlaps; none of it feeds back into the motion.
    HWY_INLINE void account(const HornMotion& horn) {
        const Vec h = hn::Set(d_, h_);
        const Vec one = hn::Set(d_, 1.0);
        std::size_t events = 0;
        HERTZLINE_EACH_ROW(k, fold_.rows()) {
            const Vec w = fold_.difference(middle_v_, k, horn.v);
            lost_.set(k, hn::MulAdd(hn::Mul(h, hn::Sub(force_[k], elastic_[k])), w, lost_[k]));
            const Flags touching = hn::Gt(overlap_[k], hn::Zero(d_));
            const Flags touched = hn::Gt(closed_[k], hn::Zero(d_));
            events += hn::CountTrue(d_, hn::Xor(touching, touched));
            closed_.set(k, hn::IfThenElseZero(touching, one));
            peak_.set(k, hn::Max(peak_[k], overlap_[k]));
        }
        work_ = hn::MulAdd(hn::Mul(h, hn::Add(force_[0], static_force_[0])), fold_.horn(horn.v), work_);
        fold_.chain().contact_events += static_cast<std::int64_t>(events);
    }

    static constexpr Doubles d_{};
    Fold<K> fold_;
    double h_;
    double per_step_;
    double lowest_;  ///< least total force of a contact [N]
    Col<K> stiffness_, static_overlap_, static_force_, damping_, inv_mass_, spring_, bias_;
    Col<K> x_, v_, closed_, peak_, lost_;
    Vec work_;
    Col<K> overlap_, elastic_, force_, middle_v_;
};

template <std::size_t K>
int advance_leapfrog(SimdChain& chain, const ToneBurst&, const HornStep* horn, std::int64_t first, int count,
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
