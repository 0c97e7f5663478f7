#pragma once
// The chain as the SIMD kernels see it: laid out over the lanes of a vector register.
//
// Striped (M. Farrar, Bioinformatics 23 (2007) 156): lane l holds the contiguous stretch of bodies l*rows ..
// l*rows + rows - 1, row k of every column is one vector. The left neighbour of row k is then row k - 1, lane
// for lane; only row 0 needs one rotation of row rows - 1. A chain of six spheres fills one AVX-512 register,
// a chain of ten thousand is a column of them, and one piece of code serves both.
//
//     rows = 2, lanes = 4:   lane   0   1   2   3
//                    row 0          b0  b2  b4  b6
//                    row 1          b1  b3  b5  pad     the last slot is always a pad that never moves
//
// Only the part of the chain that can have moved is laid out: the bodies ahead of the wavefront are at rest exactly.
//
// Linear: long chains are stepped by leapfrog in one sweep (leapfrog_sweep-inl.hpp), for which row k holds
// neighbours, and is complete as soon as the sweep has come to it. Rows of pads guard both ends. All of the
// chain is laid out once; moving_rows is how far the wavefront has come.
//
//     lanes = 4:     row 0 to 2   pads, where the horn would be
//                    row 3        b0  b1  b2  b3
//                    row 4        b4  b5  pad pad
//                    row 5 to 7   pads

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <new>
#include <vector>

#include "core/model/chain.hpp"
#include "core/model/tone_burst.hpp"

namespace hertzline::kernels {

inline constexpr std::size_t register_bytes = 64;  ///< of the widest vector register

struct FreeAligned {
    void operator()(double* p) const noexcept { ::operator delete[](p, std::align_val_t{register_bytes}); }
};

/// An array that begins where a vector register can be loaded from.
using AlignedDoubles = std::unique_ptr<double[], FreeAligned>;

/// @throws std::bad_alloc
inline AlignedDoubles aligned_zeros(std::size_t count) {
    AlignedDoubles room(
        static_cast<double*>(::operator new[](count * sizeof(double), std::align_val_t{register_bytes})));
    std::fill_n(room.get(), count, 0.0);
    return room;
}

/// Columns of a SimdChain. The first groups mirror Chain and ChainState, the others belong to the kernels.
enum class ChainField : std::size_t {
    // constants (Chain)
    stiffness,
    static_overlap,
    static_force,
    damping,
    inv_mass,
    spring,
    drag,
    bias,
    // motion and contacts (ChainState)
    x,
    v,
    closed,
    peak_overlap,
    // ledger: energy lost in each contact's dashpot and work done by the horn (contact 0) since the solver
    // last took it over [J]; gross_work adds the work that the horn gets back
    lost,
    work,
    gross_work,
    total_accel,
    last_linear = total_accel,  ///< a linear chain has no columns beyond this one
    // carried from step to step by a kernel, rebuilt by it after the chain was laid out again
    overlap,
    elastic_accel,
    closed_stiffness,
    closed_damping,
    from_left,
    from_right,
    from_self,
    loss_rate,
    loss_rate_dot,
    work_rate,
    work_rate_dot,
    held_rate,
    held_rate_dot,
    // columns of a kernel's own from here on, see SimdChain::scratch()
    first_scratch,
    count = first_scratch + 17
};

/// Rows that the kernels keep in registers; a chain of more rows is worked through in memory.
inline constexpr std::size_t max_register_rows = 8;

/// Where a body lies, see above.
enum class Layout { striped, linear };

class SimdChain {
public:
    /// Room for all bodies of the chain. @param lanes doubles in a vector register of the kernels in use.
    SimdChain(const Chain& chain, Integrator integrator, std::size_t lanes);

    /// Lays out bodies [0, active) and takes over the state. Linear: all bodies are laid out, and those from
    /// `active` on must be at rest. No allocation.
    void load(const Chain& chain, const ChainState& state, Eigen::Index active) noexcept;

    /// Writes the motion back.
    void store(ChainState& state) const noexcept;

    double* column(ChainField c) const noexcept {
        return columns_.get() + static_cast<std::size_t>(c) * stride_;
    }
    /// Results between two parts of a step. Each kernel names its own: enum class Scratch {..., count}.
    double* scratch(std::size_t i) const noexcept { return column(ChainField::first_scratch) + i * stride_; }
    static constexpr std::size_t scratch_columns =
        static_cast<std::size_t>(ChainField::count) - static_cast<std::size_t>(ChainField::first_scratch);
    std::size_t slot(Eigen::Index body) const noexcept { return slot_of_[static_cast<std::size_t>(body)]; }
    std::size_t rows() const noexcept { return rows_; }
    /// Rows by which a kernel is chosen. A chain that does not fit in registers as a whole is never worked on there: kernels in registers
    /// and in memory round differently.
    std::size_t kernel_rows() const noexcept { return all_rows_ > max_register_rows ? all_rows_ : rows_; }
    std::size_t lanes() const noexcept { return lanes_; }
    std::size_t slots() const noexcept { return rows_ * lanes_; }
    /// Slots of the ledger's columns that kernels book to.
    std::size_t ledger_slots() const noexcept { return layout_ == Layout::striped ? slots() : lanes_; }
    Eigen::Index active() const noexcept { return active_; }  ///< bodies laid out
    Layout layout() const noexcept { return layout_; }

    static constexpr std::size_t guard_rows = 3;  ///< at each end of a linear chain

    std::int64_t contact_events = 0;  ///< openings and closings so far
    std::size_t moving_rows = 0;      ///< linear: rows from here on are at rest, exactly
    double held_lost = 0;             ///< in the holder since the solver last took it over [J]
    double watched_overlap = 0;       ///< linear: kernels set ...
    bool beyond_watched = true;  ///< ... this when a contact was pressed further [m]; others leave it true
    double step_s = 0;
    bool holds = false;  ///< whether there is a holder
    bool alike =
        true;  ///< linear: all spheres are equal, and all contacts between them, and no holder slows them
    Tension tension = Tension::allowed;
    DampingLaw damping_law = DampingLaw::dashpot;
    bool rebuild = true;  ///< the kernel must rebuild the columns that it carries from step to step

private:
    std::size_t columns_used() const noexcept;
    void fill_pads() noexcept;

    Layout layout_;
    std::size_t lanes_;
    std::size_t all_rows_;  ///< of all bodies
    std::size_t rows_ = 0;
    std::size_t stride_ = 0;  ///< doubles from one column to the next
    Eigen::Index active_ = 0;
    AlignedDoubles columns_;
    std::vector<std::uint32_t> slot_of_;  ///< a table: divisions are slow
};

}  // namespace hertzline::kernels
