// The data of a step of Chin's algorithm: the chain now and after the step. Included once per SIMD target.
#if defined(HERTZLINE_CHIN4A_CHAIN_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HERTZLINE_CHIN4A_CHAIN_INL
#undef HERTZLINE_CHIN4A_CHAIN_INL
#else
#define HERTZLINE_CHIN4A_CHAIN_INL
#endif

#include "core/integrators/simd/record-inl.hpp"
#include "core/integrators/simd/striped_rows-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace hertzline::kernels {
namespace HWY_NAMESPACE {

/// Displacement, velocity and elastic acceleration (carried over: the end of a step is the start of the next).
template <std::size_t K>
struct Motion {
    Col<K> x, v, a;
};

/// Results at the end of a step besides the motion: contacts, and the power that the ledger integrates.
template <std::size_t K>
struct Node {
    Col<K> overlap;         ///< [m]
    Col<K> total_accel;     ///< with dashpots [m/s^2]
    Col<K> loss, loss_dot;  ///< lambda w^2 [W] and its slope [W/s]
    Vec work, work_dot;     ///< force on the horn times its velocity [W], slope [W/s]; lane 0
    Vec held, held_dot;     ///< loss in the holder [W], slope [W/s]
};

/// The dashpots' decay of a velocity over half a step, by the velocities of a body and of its neighbours.
template <std::size_t K>
struct Decay {
    Col<K> left, right, self;
};

template <std::size_t K>
struct Chin4aChain {
    enum class Scratch {
        next_x,
        next_v,
        next_a,
        next_overlap,
        next_total_accel,
        next_loss,
        next_loss_dot,
        drift_term,
        drift_following,
        force,
        stretch,
        root_stiffness,
        part_left,
        part_right,
        part_self,
        crossing_time,
        closed_last,
        count
    };

    explicit HWY_INLINE Chin4aChain(SimdChain& chain)
        : rows(chain),
          h(chain.step_s),
          per_half_step(2 / chain.step_s),
          tension(chain.tension),
          static_overlap(rows.load(ChainField::static_overlap)),
          static_force(rows.load(ChainField::static_force)),
          inv_mass(rows.load(ChainField::inv_mass)),
          spring(rows.load(ChainField::spring)),
          drag(rows.load(ChainField::drag)),
          bias(rows.load(ChainField::bias)),
          closed(rows.load(ChainField::closed)),
          peak(rows.load(ChainField::peak_overlap)),
          lost(rows.load(ChainField::lost)),
          work(chain),
          closed_stiffness(rows.load(ChainField::closed_stiffness)),
          closed_damping(rows.load(ChainField::closed_damping)),
          decay{rows.load(ChainField::from_left), rows.load(ChainField::from_right),
                rows.load(ChainField::from_self)},
          now{rows.load(ChainField::x), rows.load(ChainField::v), rows.load(ChainField::elastic_accel)},
          node{rows.load(ChainField::overlap),
               rows.load(ChainField::total_accel),
               rows.load(ChainField::loss_rate),
               rows.load(ChainField::loss_rate_dot),
               load_row(chain.column(ChainField::work_rate)),
               load_row(chain.column(ChainField::work_rate_dot)),
               load_row(chain.column(ChainField::held_rate)),
               load_row(chain.column(ChainField::held_rate_dot))},
          next{rows.load(Scratch::next_x), rows.load(Scratch::next_v), rows.load(Scratch::next_a)},
          next_node{rows.load(Scratch::next_overlap),
                    rows.load(Scratch::next_total_accel),
                    rows.load(Scratch::next_loss),
                    rows.load(Scratch::next_loss_dot),
                    zero(),
                    zero(),
                    zero(),
                    zero()},
          root_stiffness(rows.scratch(Scratch::root_stiffness)) {}

    HWY_INLINE void save() const {
        save_motion();
        rows.store(ChainField::elastic_accel, now.a);
        rows.store(ChainField::closed, closed);
        rows.store(ChainField::peak_overlap, peak);
        rows.store(ChainField::lost, lost);
        rows.store(ChainField::closed_stiffness, closed_stiffness);
        rows.store(ChainField::closed_damping, closed_damping);
        rows.store(ChainField::from_left, decay.left);
        rows.store(ChainField::from_right, decay.right);
        rows.store(ChainField::from_self, decay.self);
        rows.store(ChainField::overlap, node.overlap);
        rows.store(ChainField::loss_rate, node.loss);
        rows.store(ChainField::loss_rate_dot, node.loss_dot);
        const SimdChain& chain = rows.chain();
        work.save(chain);
        store_row(node.work, chain.column(ChainField::work_rate));
        store_row(node.work_dot, chain.column(ChainField::work_rate_dot));
        store_row(node.held, chain.column(ChainField::held_rate));
        store_row(node.held_dot, chain.column(ChainField::held_rate_dot));
    }
    /// Saves as much of a whole step that crosses as its crossings are found from.
    HWY_INLINE void save_trial() const {
        rows.store(Scratch::next_x, next.x);
        rows.store(Scratch::next_v, next.v);
        rows.store(Scratch::next_overlap, next_node.overlap);
    }
    /// Saves the motion, which rows of a trace are recorded from.
    HWY_INLINE void save_motion() const {
        rows.store(ChainField::x, now.x);
        rows.store(ChainField::v, now.v);
        rows.store(ChainField::total_accel, node.total_accel);
    }

    StripedRows<K> rows;
    double h;
    double per_half_step;
    Tension tension;
    Col<K> static_overlap, static_force, inv_mass, spring, drag, bias;
    Col<K> closed, peak, lost;
    HornWork work;
    Col<K> closed_stiffness, closed_damping;  ///< zero where a contact is open
    Decay<K> decay;
    Motion<K> now;
    Node<K> node;
    Motion<K> next;
    Node<K> next_node;
    Col<K> root_stiffness;  ///< k sqrt(delta) of the last forces()
};

}  // namespace HWY_NAMESPACE
}  // namespace hertzline::kernels
HWY_AFTER_NAMESPACE();

#endif
