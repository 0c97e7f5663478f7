// Where contacts open and close, quadratures fall short of their order: the excess of the kicks and of the ledger of Chin's
// algorithm there, and its correction. Included once per SIMD target.
//
// Within a time tau of its closing or opening at a relative velocity w a contact presses with k |w tau|^(3/2). The kicks of a step
// integrate that by Simpson's rule, the ledger integrates its power by Hermite's, and both rules err there by h^(5/2), a lower order
// than the method's. By how much is known once it is known when the contact switches: it is the error of the rule for tau^(3/2), summed up
// over the steps about that moment.
#if defined(HERTZLINE_SWITCHING_KICK_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HERTZLINE_SWITCHING_KICK_INL
#undef HERTZLINE_SWITCHING_KICK_INL
#else
#define HERTZLINE_SWITCHING_KICK_INL
#endif

#include <cmath>

#include "core/integrators/chin4a/chin4a_chain-inl.hpp"
#include "core/integrators/simd/contact-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace hertzline::kernels {
namespace HWY_NAMESPACE {

/// Excess of the rules over the integral of tau^(3/2).
struct Excess {
    double of_kicks = 0;
    double of_ledger = 0;

    HWY_INLINE Excess operator+(const Excess& other) const {
        return {of_kicks + other.of_kicks, of_ledger + other.of_ledger};
    }
    HWY_INLINE Excess operator-(const Excess& other) const {
        return {of_kicks - other.of_kicks, of_ledger - other.of_ledger};
    }
};

/// A moment, in steps from that of the switching.
struct FromSwitching {
    HWY_INLINE explicit FromSwitching(double time) : t(time), root(std::sqrt(time)) {}
    HWY_INLINE double force() const { return t * root; }
    HWY_INLINE double impulse() const { return 0.4 * t * t * root; }
    double t;
    double root;
};

/// In a step, or a part of one.
HWY_INLINE Excess excess_between(const FromSwitching& from, const FromSwitching& to) {
    const double length = to.t - from.t;
    const FromSwitching middle(0.5 * (from.t + to.t));
    const double ends = from.force() + to.force();
    const double simpson = length / 6 * (ends + 4 * middle.force());
    const double hermite = length / 2 * ends + length * length / 8 * (from.root - to.root);
    const double exact = to.impulse() - from.impulse();
    return {simpson - exact, hermite - exact};
}

/// In the steps on one side of a switching. The rules are good enough from the fourth on.
/// @param next,second lengths of the first two in steps; whole ones follow
HWY_INLINE Excess excess_beside(double next, double second) {
    const FromSwitching none(0), one(next), two(next + second), three(next + second + 1);
    return excess_between(none, one) + excess_between(one, two) + excess_between(two, three);
}

/// Change of the excess of one part when it is cut in two.
HWY_INLINE Excess excess_by_cut(double first, double whole) {
    const FromSwitching none(0), cut(first), end(whole);
    return excess_between(none, cut) + excess_between(cut, end) - excess_between(none, end);
}

/// Takes the excess back where contacts switch in a step, which may be in several places.
template <std::size_t K>
class SwitchingKick {
public:
    explicit HWY_INLINE SwitchingKick(const Chin4aChain<K>& c)
        : closed_last_(c.rows.scratch(Chin4aChain<K>::Scratch::closed_last)) {}

    /// A part of the step has been taken, up to where contacts switch. @param length in steps
    HWY_INLINE void add_part(double length) {
        second_ = next_ > 0 ? next_ : 1;
        next_ = length;
        cut_ = left_ > 0;
    }

    /// Kicks the bodies whose contacts are about to switch, on the motion now, and corrects the work in the ledger.
    /// @param times when each contact switches, at the latest at `time` if it does
    /// @param horn_v [m/s] @param left of the step, in steps
    HWY_INLINE void operator()(Chin4aChain<K>& c, const Col<K>& times, double time, double horn_v,
                               double left) {
        using Scratch = typename Chin4aChain<K>::Scratch;
        Col<K> impulse = c.rows.scratch(Scratch::stretch);
        Col<K> in_ledger = c.rows.scratch(Scratch::force);
        Col<K> missed = c.rows.scratch(Scratch::drift_term);
        const Col<K> stiffness = c.rows.load(ChainField::stiffness);
        const Vec unit = splat(-c.h * c.h * std::sqrt(c.h));
        // a contact without tension lets go while it is still pressed
        const Excess opening = c.tension == Tension::allowed ? excess_beside(next_, second_) : Excess();
        const Excess closing = excess_beside(left, 1);
        // those that closed before in this step were thought to have the rest of it in one part
        const Excess cut = cut_ ? excess_by_cut(next_, left_) : Excess();
        HERTZLINE_EACH_ROW(k, c.rows.count()) {
            const Vec speed = Abs(c.rows.difference(c.now.v, k, horn_v));
            const Vec switching =
                IfThenElseZero(Le(times[k], splat(time)), unit * hertz(stiffness[k], speed));
            const Vec opens = c.closed[k] * switching;
            const Vec closes = switching - opens;
            const Vec closed_last = cut_ ? closed_last_[k] : zero();
            const auto sum = [&](double Excess::*part) HWY_ATTR {
                const Vec of_closings = MulAdd(splat(closing.*part), closes, splat(cut.*part) * closed_last);
                return MulAdd(splat(opening.*part), opens, of_closings);
            };
            impulse.set(k, sum(&Excess::of_kicks));
            in_ledger.set(k, sum(&Excess::of_ledger));
            // the part of a kick that comes after its closing has not moved the bodies since then
            missed.set(k, splat(cut.of_kicks * next_ * c.h) * closed_last);
            closed_last_.set(k, closes);
        }
        left_ = left;
        cut_ = false;
        c.work.add(in_ledger[0] * c.rows.horn(horn_v));
        HERTZLINE_EACH_ROW(k, c.rows.count()) {
            const Vec net = impulse[k] - c.rows.right(impulse, k);
            c.now.v.set(k, MulAdd(c.inv_mass[k], net, c.now.v[k]));
            const Vec way = missed[k] - c.rows.right(missed, k);
            c.now.x.set(k, MulAdd(c.inv_mass[k], way, c.now.x[k]));
        }
    }

private:
    double next_ = 0, second_ = 1;  ///< lengths of the parts taken before, the last one first
    double left_ = 0;               ///< of the step at the last switching
    bool cut_ = false;              ///< since then a part of that has been taken, not all
    Col<K> closed_last_;            ///< impulses of the contacts that closed there, by their excess
};

}  // namespace HWY_NAMESPACE
}  // namespace hertzline::kernels
HWY_AFTER_NAMESPACE();

#endif
