// Leapfrog for long chains: the step of leapfrog-inl.hpp as one sweep along the chain, many steps at once.
//
// A body after a step depends on two neighbours to either side before it. So a step needs no columns of
// intermediate results. As row k comes in, its overlaps are worked out, the forces of row k - 1, the velocities at
// mid-step of row k - 2 and the final motion of row k - 3; intermediate results stay in registers:
//
//     row k        x, v in; overlap and its square root
//     row k - 1    forces, dashpots at the velocity at the start
//     row k - 2    velocity at mid-step; forces, dashpots at that velocity
//     row k - 3    velocity, displacement out
//
// The next step can follow three rows behind. A block of steps goes along the chain like that, a tile of rows
// at a time, and while it does, the rows lie in the nearest caches: each is fetched from memory once per
// block instead of once per step. Every row of every step is worked out from the same numbers in the same way
// however the steps are grouped, so the bits do not depend on it.
//
// The chain's layout is linear (simd_chain.hpp): spheres that the wave has not reached are rows that no sweep gets
// to. Each step goes two bodies beyond the last row that moves, as far as a step can carry a disturbance, and looks
// whether they have begun to: a body is at rest when its displacement and velocity are zero, exactly.
#if defined(HERTZLINE_LEAPFROG_SWEEP_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HERTZLINE_LEAPFROG_SWEEP_INL
#undef HERTZLINE_LEAPFROG_SWEEP_INL
#else
#define HERTZLINE_LEAPFROG_SWEEP_INL
#endif

#include <array>

#include "core/integrators/simd/contact-inl.hpp"
#include "core/integrators/simd/record-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace hertzline::kernels {
namespace HWY_NAMESPACE {

/// Neighbours of a row, which lie partly in the row beside it. AVX-512 shifts two registers in one
/// instruction, for which Highway has no word.
class LinearRows {
public:
    // NOLINTNEXTLINE(modernize-use-equals-default): a defaulted one would be compiled for the baseline
    HWY_INLINE LinearRows() {}

    /// Values to the left of a row's; of the row before only the last counts.
    HWY_INLINE Vec left(Vec before, Vec row) const {
#if HWY_TARGET <= HWY_AVX3
        return Vec{_mm512_castsi512_pd(
            _mm512_alignr_epi64(_mm512_castpd_si512(row.raw), _mm512_castpd_si512(before.raw), 7))};
#else
        const Flags first = hn::FirstN(Doubles(), 1);
        return IfThenElse(first, rotation_.up(before), rotation_.up(row));
#endif
    }
    /// Values to the right of a row's; of the row after only the first counts.
    HWY_INLINE Vec right(Vec row, Vec after) const {
#if HWY_TARGET <= HWY_AVX3
        return Vec{_mm512_castsi512_pd(
            _mm512_alignr_epi64(_mm512_castpd_si512(after.raw), _mm512_castpd_si512(row.raw), 1))};
#else
        const Flags own = hn::FirstN(Doubles(), lanes() - 1);
        return IfThenElse(own, rotation_.down(row), rotation_.down(after));
#endif
    }

private:
    Rotation rotation_;
};

/// Rows between the ends of the chain are all alike: equal spheres, equal contacts.
enum class Rows { alike, any };

template <Tension tension>
class LeapfrogSweep {
public:
    explicit HWY_INLINE LeapfrogSweep(SimdChain& chain)
        : chain_(&chain),
          h_(chain.step_s),
          first_(SimdChain::guard_rows),
          end_(chain.rows() - SimdChain::guard_rows),
          alike_from_(first_ + 1),
          alike_to_(chain.alike ? chain.slot(chain.active() - 1) / lanes() : 0),
          lost_(row(ChainField::lost, 0)),
          work_(chain) {}

    /// Takes `count` steps (at most max_steps). `finished` is called after each; the rows near
    /// the end of the chain are then as that step left them.
    template <class Finished>
    HWY_INLINE void block(const HornStep* horn, std::size_t count, Finished&& finished) {
        for (std::size_t s = 0; s < count; ++s) {
            places_[s] = {first_, at_the_horn(horn[s].middle)};
        }
        const std::size_t end = sweep_end();
        for (std::size_t to = first_ + tile_rows; to + tile_rows < end; to += tile_rows) {
            for (std::size_t s = 0; s < count && to > first_ + row_delay * s; ++s) {
                sweep(places_[s], to - row_delay * s, horn[s].middle);
            }
        }
        for (std::size_t s = 0; s < count; ++s) {
            sweep(places_[s], sweep_end(), horn[s].middle);
            lost_ = MulAdd(splat(h_), places_[s].carry.loss, lost_);
            if (HWY_UNLIKELY(chain_->holds)) {
                chain_->held_lost += h_ * GetLane(hn::SumOfLanes(Doubles(), places_[s].carry.held));
            }
            advance_front();
            finished();
        }
    }

    HWY_INLINE void save_ledger() const {
        store_row(lost_, chain_->column(ChainField::lost));
        work_.save(*chain_);
    }

    /// Accelerations of the bodies from `body` on, for samples between steps. Not part of the integration.
    HWY_INLINE void save_accelerations(Eigen::Index body, const HornMotion& horn) const {
        const std::size_t from = chain_->slot(body) / lanes();
        Vec x1 = from == first_ ? splat(horn.x) : row(ChainField::x, from - 1);
        Vec v1 = from == first_ ? splat(horn.v) : row(ChainField::v, from - 1);
        Vec force1 = zero();
        for (std::size_t k = from; k <= end_; ++k) {
            const Constants c = constants(k);
            const Vec x = row(ChainField::x, k);
            const Vec v = row(ChainField::v, k);
            const Vec overlap = rows_.left(x1, x) + (c.static_overlap - x);
            const Vec dashpot = c.damping * (rows_.left(v1, v) - v);
            const Vec pulled = IfThenElseZero(Gt(overlap, zero()), dashpot);
            const Vec elastic = elastic_force(c.stiffness, overlap) - c.static_force;
            const Vec force = limited(c, elastic + pulled);
            if (k > from) {
                const Constants c1 = constants(k - 1);
                const Vec net = force1 - rows_.right(force1, force) + c1.grounded(x1, v1);
                store_row(c1.inv_mass * net, chain_->column(ChainField::total_accel) + (k - 1) * lanes());
            }
            x1 = x;
            v1 = v;
            force1 = force;
        }
    }

    static constexpr std::size_t max_steps = 32;

private:
    static constexpr std::size_t row_delay = 3;   ///< rows from coming in to being done
    static constexpr std::size_t tile_rows = 32;  ///< and those of all steps fit into the nearest cache

    /// Per body and its left contact, as in Chain.
    struct Constants {
        Vec stiffness, static_overlap, static_force, damping, inv_mass, spring, drag, bias;
        /// Forces on a body besides those of its contacts. @param v velocity by which the holder slows
        HWY_INLINE Vec grounded(Vec x, Vec v) const { return NegMulAdd(drag, v, NegMulAdd(spring, x, bias)); }
    };

    /// Values that a step hands on from row to row. Rows 1, 2, 3 are that many before the row that comes in next.
    struct Carry {
        Vec x1, v1;           ///< at mid-step, at the start
        Vec overlap1, root1;  ///< its square root, on which nothing in the same turn has to wait
        Vec x2, v2;
        Vec shift2, elastic2;   ///< overlap / h; elastic force
        Vec force2;             ///< at the velocity at the start
        Vec x3, v3, middle_v3;  ///< and velocity at mid-step
        Vec total3;             ///< force at the velocity at mid-step
        Vec loss;               ///< in all rows so far [W]
        Vec held;               ///< of the holder
    };
    /// Constants of the loop over rows, the same for all rows.
    struct Step {
        explicit HWY_INLINE Step(const SimdChain& chain)
            : h(splat(chain.step_s)),
              half(splat(0.5 * chain.step_s)),
              per_step(splat(1 / chain.step_s)),
              watched(splat(chain.watched_overlap)),
              x(chain.column(ChainField::x)),
              v(chain.column(ChainField::v)),
              closed(chain.column(ChainField::closed)),
              peak(chain.column(ChainField::peak_overlap)) {}
        Vec h, half, per_step, watched;
        double* x;
        double* v;
        double* closed;
        double* peak;
    };
    /// How far a step has come.
    struct Place {
        std::size_t next_row;
        Carry carry;
    };

    HWY_INLINE Vec row(ChainField c, std::size_t k) const {
        return load_row(chain_->column(c) + k * lanes());
    }
    HWY_INLINE Constants constants(std::size_t k) const {
        return {row(ChainField::stiffness, k),    row(ChainField::static_overlap, k),
                row(ChainField::static_force, k), row(ChainField::damping, k),
                row(ChainField::inv_mass, k),     row(ChainField::spring, k),
                row(ChainField::drag, k),         row(ChainField::bias, k)};
    }

    /// The row before the first is the horn, which no force moves.
    static HWY_INLINE Carry at_the_horn(const HornMotion& horn) {
        const Vec none = zero();
        const Vec x = splat(horn.x);
        const Vec v = splat(horn.v);
        return {x, v, none, none, x, v, none, none, none, x, v, v, none, none, none};
    }

    /// In one step a disturbance travels two bodies; the rows that it may reach are done three rows later.
    HWY_INLINE std::size_t sweep_end() const {
        return std::min(chain_->moving_rows + (2 + lanes() - 1) / lanes(), end_) + row_delay;
    }
    HWY_INLINE void advance_front() const {
        const std::size_t done = sweep_end() - row_delay;
        for (std::size_t k = chain_->moving_rows; k < done; ++k) {
            const Flags still = And(Eq(row(ChainField::x, k), zero()), Eq(row(ChainField::v, k), zero()));
            chain_->moving_rows = all(still) ? chain_->moving_rows : k + 1;
        }
    }

    /// A step takes in the rows before `to`.
    HWY_INLINE void sweep(Place& place, std::size_t to, const HornMotion& horn) {
        take_in<Rows::any>(place, std::min(to, alike_from_ + row_delay), horn);
        take_in<Rows::alike>(place, std::min(to, alike_to_), horn);
        take_in<Rows::any>(place, to, horn);
    }

    /// Everything that the loop uses is copied to it first, to be kept in registers.
    template <Rows rows>
    HWY_NOINLINE void take_in(Place& place, std::size_t to, const HornMotion& horn) {
        if (place.next_row >= to) {
            return;
        }
        Carry carry = place.carry;
        const Step step(*chain_);
        Constants c = constants(rows == Rows::alike ? alike_from_ : place.next_row);
        Constants c1 = rows == Rows::alike ? c : constants(place.next_row - 1);
        Constants c2 = rows == Rows::alike ? c : constants(place.next_row - 2);
        Constants c3 = rows == Rows::alike ? c : constants(place.next_row - 3);
        for (std::size_t k = place.next_row; k < to; ++k) {
            if (rows == Rows::any) {
                c = constants(k);
            }
            row_in<rows>(step, k, c, c1, c2, c3, carry);
            if (rows == Rows::any) {
                if (k == first_ + 2) {
                    book_work(carry.total3, horn.v);
                }
                c3 = c2;
                c2 = c1;
                c1 = c;
            }
        }
        place = {to, carry};
    }

    /// Row k comes in, row k - 3 is done. @param c, c1, c2, c3 constants of rows k to k - 3
    template <Rows rows>
    HWY_INLINE void row_in(const Step& step, std::size_t k, const Constants& c, const Constants& c1,
                           const Constants& c2, const Constants& c3, Carry& carry) const {
        double* const x_in = step.x + k * lanes();
        double* const v_in = step.v + k * lanes();
        // row k: drift to mid-step, overlaps there
        const Vec v = load_row(v_in);
        const Vec x = MulAdd(step.half, v, load_row(x_in));
        const Vec overlap = rows_.left(carry.x1, x) + (c.static_overlap - x);
        const Vec root = Sqrt(pressed(overlap));
        watch<rows>(step, k, c, overlap);
        // row k - 1: forces, with the dashpots at the velocity at the start
        const Vec shift = carry.overlap1 * step.per_step;
        const Vec elastic = elastic_force(c1.stiffness, carry.overlap1, carry.root1) - c1.static_force;
        const Vec force = total(c1, elastic, shift, rows_.left(carry.v2, carry.v1) - carry.v1);
        // row k - 2: velocity at mid-step by half a kick, forces with the dashpots at that velocity
        const Vec middle_v = kicked<rows>(c2, carry.v2, step.half, carry.force2, force, carry.x2, carry.v2);
        const Vec w = rows_.left(carry.middle_v3, middle_v) - middle_v;
        const Vec total2 = total(c2, carry.elastic2, carry.shift2, w);
        if (rows == Rows::any) {
            carry.held = MulAdd(c2.drag * middle_v, middle_v, carry.held);
        }
        const Vec loss = MulAdd(total2 - carry.elastic2, w, carry.loss);
        // row k - 3: the whole kick, drift to the end of the step
        const Vec end_v = kicked<rows>(c3, carry.v3, step.h, carry.total3, total2, carry.x3, carry.middle_v3);
        store_row(end_v, v_in - row_delay * lanes());
        store_row(MulAdd(step.half, end_v, carry.x3), x_in - row_delay * lanes());
        // one row on; member by member, or the compiler does it in memory
        carry.x3 = carry.x2;
        carry.v3 = carry.v2;
        carry.middle_v3 = middle_v;
        carry.total3 = total2;
        carry.loss = loss;
        carry.x2 = carry.x1;
        carry.v2 = carry.v1;
        carry.shift2 = shift;
        carry.elastic2 = elastic;
        carry.force2 = force;
        carry.x1 = x;
        carry.v1 = v;
        carry.overlap1 = overlap;
        carry.root1 = root;
    }

    /// Adds the dashpots' forces to the elastic ones: lambda w, weighed by the part of the step in contact.
    static HWY_INLINE Vec total(const Constants& c, Vec elastic, Vec shift, Vec w) {
        return limited(c, MulAdd(c.damping, weighed_by_contact(w, shift), elastic));
    }
    /// Clamped: no contact pulls.
    static HWY_INLINE Vec limited(const Constants& c, Vec force) {
        return tension == Tension::clamped ? Max(force, Neg(c.static_force)) : force;
    }
    /// Velocities after the forces of the contacts to the left, and of those to the right, have acted. @param u by which the holder slows
    template <Rows rows>
    HWY_INLINE Vec kicked(const Constants& c, Vec v, Vec time, Vec force, Vec next_force, Vec x,
                          Vec u) const {
        const Vec net = force - rows_.right(force, next_force);
        return MulAdd(time * c.inv_mass, rows == Rows::alike ? net : net + c.grounded(x, u), v);
    }

    /// Contact events and peak overlaps; none of it feeds back into the motion.
    template <Rows rows>
    HWY_INLINE void watch(const Step& step, std::size_t k, const Constants& c, Vec overlap) const {
        double* const closed = step.closed + k * lanes();
        double* const peak = step.peak + k * lanes();
        store_row(Max(load_row(peak), overlap), peak);
        const Flags touching = Gt(overlap, zero());
        const Flags changed = Xor(touching, Gt(load_row(closed), zero()));
        Flags within = Le(overlap, step.watched);
        if (rows == Rows::any) {
            within = Or(within, Eq(c.stiffness, zero()));  // no contact
        }
        if (HWY_UNLIKELY(any(Or(changed, Not(within))))) {
            chain_->beyond_watched = chain_->beyond_watched || !all(within);
            chain_->contact_events += static_cast<std::int64_t>(CountTrue(Doubles(), changed));
            store_row(one_where(touching), closed);
        }
    }

    HWY_INLINE void book_work(Vec total, double horn_v) {
        const Vec whole = total + row(ChainField::static_force, first_);
        const Vec on_first = IfThenElseZero(hn::FirstN(Doubles(), 1), whole);
        work_.add(splat(h_ * horn_v) * on_first);
    }

    SimdChain* chain_;
    LinearRows rows_;
    double h_;
    std::size_t first_, end_;            ///< rows of bodies
    std::size_t alike_from_, alike_to_;  ///< rows of equal spheres and contacts
    Vec lost_;
    HornWork work_;
    std::array<Place, max_steps> places_;
};

template <Tension tension>
int sweep_leapfrog(SimdChain& chain, const HornStep* horn, std::int64_t first, int count, Trace& trace) {
    LeapfrogSweep<tension> leapfrog(chain);
    int taken = 0;
    while (taken < count && trace.has_room()) {
        const std::int64_t left = std::min<std::int64_t>(count - taken, LeapfrogSweep<tension>::max_steps);
        const auto together = static_cast<std::size_t>(trace.steps_together(first + taken, left));
        leapfrog.block(horn + taken, together, [&]() HWY_ATTR {
            if (trace.between) {
                leapfrog.save_accelerations(trace.first_body, horn[taken].end);
            }
            ++taken;
            if (trace.next == first + taken) {
                record(chain, trace, first + taken, 0);
            }
        });
    }
    leapfrog.save_ledger();
    return taken;
}

inline int advance_leapfrog_linear(SimdChain& chain, const Horn&, const HornStep* horn, std::int64_t first,
                                   int count, Trace& trace) {
    return chain.tension == Tension::clamped
               ? sweep_leapfrog<Tension::clamped>(chain, horn, first, count, trace)
               : sweep_leapfrog<Tension::allowed>(chain, horn, first, count, trace);
}

}  // namespace HWY_NAMESPACE
}  // namespace hertzline::kernels
HWY_AFTER_NAMESPACE();

#endif
