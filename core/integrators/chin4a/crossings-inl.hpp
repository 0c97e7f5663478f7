// Where contacts open and close within a step of Chin's algorithm. Included once per SIMD target.
#if defined(HERTZLINE_CROSSINGS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HERTZLINE_CROSSINGS_INL
#undef HERTZLINE_CROSSINGS_INL
#else
#define HERTZLINE_CROSSINGS_INL
#endif

#include "core/integrators/chin4a/chin4a_chain-inl.hpp"
#include "core/integrators/chin4a/frozen_step-inl.hpp"
#include "core/integrators/chin4a/switching_kick-inl.hpp"
#include "core/integrators/kernels.hpp"
#include "core/integrators/simd/contact-inl.hpp"
#include "core/model/horn.hpp"
#include "core/simd/roots-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace hertzline::kernels {
namespace HWY_NAMESPACE {

/// The horn over a part of a step, as the quintic through its motion at both ends (error 1e-11 of the
/// amplitude at 200 ns).
class HornCurve {
public:
    HWY_INLINE HornCurve(const HornMotion& from, const HornMotion& to, double duration_s)
        : duration_(duration_s), from_(from) {
        const double d = duration_s;
        const double x = to.x - from.x - d * (from.v + 0.5 * d * from.a);
        const double v = d * (to.v - from.v - d * from.a);
        const double a = d * d * (to.a - from.a);
        using One = hn::CappedTag<double, 1>;  // fused where the instructions have it, as all kernels
        const auto xx = hn::Set(One(), x);
        c3_ = GetLane(MulSub(hn::Set(One(), 10.0), xx, hn::Set(One(), 4 * v))) + 0.5 * a;
        c4_ = GetLane(MulAdd(hn::Set(One(), -15.0), xx, hn::Set(One(), 7 * v))) - a;
        c5_ = 6 * x - 3 * v + 0.5 * a;
    }
    /// @param z fraction of the part
    HWY_INLINE HornMotion at(double z) const {
        const double d = duration_;
        const double t = z * d;
        return {from_.x + t * (from_.v + 0.5 * t * from_.a) + z * z * z * (c3_ + z * (c4_ + z * c5_)),
                from_.v + t * from_.a + z * z * (3 * c3_ + z * (4 * c4_ + z * 5 * c5_)) / d,
                from_.a + z * (6 * c3_ + z * (12 * c4_ + z * 20 * c5_)) / (d * d)};
    }
    HWY_INLINE double duration_s() const { return duration_; }

private:
    double duration_;
    HornMotion from_;
    double c3_, c4_, c5_;
};

/// Contact switches that one smooth part of a step may be split at. Contacts may chatter for ever in theory:
/// after as many the step is taken as it is.
inline constexpr int max_switches = 40;
static_assert(2 * max_switches < static_cast<int>(max_rows_per_step), "each is recorded before and after");

/// Crossings closer than this [fraction of the part] are one.
inline constexpr double same_moment = 1e-9;

/// Whether a whole part of a step was already tried, and found to cross, before it is taken in pieces.
enum class Trial { not_yet, crossed };

/// Whether the contact law has contact k closed at an overlap [m] and a relative velocity [m/s].
template <std::size_t K>
HWY_INLINE Flags touches(const Chin4aChain<K>& c, std::size_t k, Vec overlap, Vec w) {
    const Flags overlapping = Gt(overlap, zero());
    if (HWY_LIKELY(c.tension == Tension::allowed)) {
        return overlapping;
    }
    // without tension a contact lets go as soon as dashpot and elasticity together would pull
    const Vec stiffness = c.rows.load(ChainField::stiffness)[k];
    const Vec force = MulAdd(c.rows.load(ChainField::damping)[k], w, elastic_force(stiffness, overlap));
    const Flags pad = Eq(stiffness, zero());
    return Or(pad, And(overlapping, Gt(force, zero())));
}

/// Contacts that open or close in the step.
template <std::size_t K>
HWY_INLINE Flags crosses(const Chin4aChain<K>& c, std::size_t k, const HornMotion& end) {
    const Vec w = c.rows.difference(c.next.v, k, end.v);
    return Xor(touches(c, k, c.next_node.overlap[k], w), Gt(c.closed[k], zero()));
}
template <std::size_t K>
HWY_INLINE bool any_crosses(const Chin4aChain<K>& c, const HornMotion& end) {
    Flags found = crosses(c, 0, end);
    HERTZLINE_EACH_ROW(k, c.rows.count()) found = Or(found, crosses(c, k, end));
    return any(found);
}

/// Overlap of a contact over a step: the cubic through overlap and relative velocity at both ends.
struct OverlapCubic {
    Vec c0, c1, c2, c3;
    HWY_INLINE Vec operator()(Vec z) const { return MulAdd(z, MulAdd(z, MulAdd(z, c3, c2), c1), c0); }
    HWY_INLINE Vec slope(Vec z) const { return MulAdd(z, MulAdd(z, splat(3.0) * c3, c2 + c2), c1); }
};
template <std::size_t K>
HWY_INLINE OverlapCubic overlap_cubic(const Chin4aChain<K>& c, std::size_t k, double h,
                                      const HornMotion& begin, const HornMotion& end) {
    const Vec duration = splat(h);
    const Vec o0 = c.rows.difference(c.static_overlap[k], c.now.x, k, begin.x);
    const Vec w0 = duration * c.rows.difference(c.now.v, k, begin.v);
    const Vec w1 = duration * c.rows.difference(c.next.v, k, end.v);
    const Vec rise = c.next_node.overlap[k] - o0;
    return {o0, w0, splat(3.0) * rise - (w0 + w0) - w1, (w0 + w1) - (rise + rise)};
}

/// Fraction of the step from now to next at which contact k crosses, where that is wanted.
template <std::size_t K>
HWY_INLINE Vec crossing_time(const Chin4aChain<K>& c, std::size_t k, double h, const HornMotion& begin,
                             const HornMotion& end, Flags wanted) {
    const Vec one = splat(1.0);
    const OverlapCubic overlap = overlap_cubic(c, k, h, begin, end);
    const Flags closing = Eq(c.closed[k], zero());
    if (c.tension == Tension::clamped) {  // the law has no simple slope
        const auto crossed = [&](Vec z) HWY_ATTR {
            return Not(Xor(touches(c, k, overlap(z), overlap.slope(z) / splat(h)), closing));
        };
        return bisect(crossed, one).high;
    }
    const auto value = [&](Vec z, Vec& slope) HWY_ATTR {
        slope = overlap.slope(z);
        return overlap(z);
    };
    const Vec rise = c.next_node.overlap[k] - overlap.c0;
    const Vec secant = Neg(overlap.c0) / rise;
    const Flags sound = And(Gt(secant, zero()), Lt(secant, one));
    constexpr int max_rounds = 5;
    return bracketed_newton(value, {.guess = IfThenElse(sound, secant, splat(0.5)),
                                    .high = one,
                                    .rising = closing,
                                    .tolerance = splat(1e-8),
                                    .wanted = wanted,
                                    .max_rounds = max_rounds});
}

/// Takes a fraction of a smooth part of a step from `done` on, to next.
template <std::size_t K>
HWY_NOINLINE void advance(Chin4aChain<K>& c, const HornCurve& horn, double done, double fraction) {
    using Scratch = typename Chin4aChain<K>::Scratch;
    Decay<K> decay{c.rows.scratch(Scratch::part_left), c.rows.scratch(Scratch::part_right),
                   c.rows.scratch(Scratch::part_self)};
    const Vec scale = splat(fraction * horn.duration_s() / c.h);
    HERTZLINE_EACH_ROW(k, c.rows.count()) {
        decay.left.set(k, scale * c.decay.left[k]);
        decay.right.set(k, scale * c.decay.right[k]);
        decay.self.set(k, scale * c.decay.self[k]);
    }
    const double duration_s = fraction * horn.duration_s();
    const auto half_drift = [&](Chin4aChain<K>& chin) HWY_ATTR { drift(chin, 0.5 * duration_s, decay); };
    frozen_step(c, duration_s, half_drift, horn.at(done + 0.5 * fraction), horn.at(done + fraction));
}

/// When contacts cross, between `done` and the end of the part, as fractions of that; 2: not at all.
/// @returns the first
template <std::size_t K>
HWY_INLINE double first_crossing(const Chin4aChain<K>& c, const HornCurve& horn, double done, Col<K>& times) {
    const HornMotion begin = horn.at(done);
    const HornMotion end = horn.at(1);
    const Vec never = splat(2.0);
    Vec first = never;
    HERTZLINE_EACH_ROW(k, c.rows.count()) {
        const Flags crossing = crosses(c, k, end);
        const Vec time = crossing_time(c, k, (1 - done) * horn.duration_s(), begin, end, crossing);
        times.set(k, IfThenElse(crossing, time, never));
        first = Min(first, times[k]);
    }
    return smallest_lane(first);
}

/// Contacts that cross by `time` switch.
template <std::size_t K>
HWY_INLINE void switch_contacts(Chin4aChain<K>& c, const Col<K>& times, double time) {
    std::size_t switched = 0;
    HERTZLINE_EACH_ROW(k, c.rows.count()) {
        const Flags now = Le(times[k], splat(time));
        c.closed.set(k, IfThenElse(now, splat(1.0) - c.closed[k], c.closed[k]));
        switched += CountTrue(Doubles(), now);
    }
    c.rows.chain().contact_events += static_cast<std::int64_t>(switched);
}

/// A smooth part of a step, the contacts' crossings located: advance, find the first crossing, switch there.
/// `record_row` is called with the fraction of the part before and after each switch.
template <std::size_t K, class RecordRow>
HWY_INLINE void advance_located(Chin4aChain<K>& c, const HornCurve& horn, Trial trial,
                                RecordRow&& record_row) {
    Col<K> times = c.rows.scratch(Chin4aChain<K>::Scratch::crossing_time);
    const double steps_per_part = horn.duration_s() / c.h;
    SwitchingKick<K> switching_kick(c);
    double done = 0;
    for (int switches = 0;; ++switches) {
        const double rest = 1 - done;
        const bool known_to_cross = trial == Trial::crossed && switches == 0;
        if (!known_to_cross) {
            advance(c, horn, done, rest);
            if (!any_crosses(c, horn.at(done + rest)) || switches == max_switches) {
                accept(c, rest * horn.duration_s());
                return;
            }
        }
        const double first = first_crossing(c, horn, done, times);
        if (first > same_moment) {
            advance(c, horn, done, first * rest);
            accept(c, first * rest * horn.duration_s());
            done += first * rest;
            switching_kick.add_part(first * rest * steps_per_part);
        }
        record_row(done);
        const HornMotion horn_now = horn.at(done);
        switching_kick(c, times, first + same_moment, horn_now.v, (1 - done) * steps_per_part);
        switch_contacts(c, times, first + same_moment);
        rebuild(c, horn_now);
        record_row(done);
        if (1 - done <= same_moment) {
            return;
        }
    }
}

/// The horn's motion may jump where a smooth part of it begins: contact 0 is checked again. The energy that a
/// jump of the horn stores there is work.
template <std::size_t K>
HWY_INLINE void add_work_of_jump(Chin4aChain<K>& c, const HornMotion& horn) {
    const Vec stiffness = c.rows.load(ChainField::stiffness)[0];
    const Vec overlap = c.rows.difference(c.static_overlap[0], c.now.x, 0, horn.x);
    const Vec gained = elastic_energy(stiffness, overlap) - elastic_energy(stiffness, c.node.overlap[0]);
    c.work.add(c.rows.horn(1.0) * gained);
    const Vec w = c.rows.difference(c.now.v, 0, horn.v);
    const Vec touching = one_where(touches(c, 0, overlap, w));
    const Vec changed = c.rows.horn(1.0) * (touching - c.closed[0]);
    c.rows.chain().contact_events += all(Eq(changed, zero())) ? 0 : 1;
    c.closed.set(0, c.closed[0] + changed);
}

}  // namespace HWY_NAMESPACE
}  // namespace hertzline::kernels
HWY_AFTER_NAMESPACE();

#endif
