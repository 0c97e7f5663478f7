#pragma once
// What a simulation gives: blocks of samples, and what is wished for in them.

#include <cstdint>
#include <vector>

#include "core/model/chain.hpp"

namespace hertzline {

/// What a block of samples shall hold. What is not wanted is not computed.
struct Wish {
    bool outputs = true;            ///< v_last, v_plate, v_out
    bool chain_velocities = false;  ///< of all spheres
    bool chain_displacements = false;
    bool ledger = true;  ///< of energy; settled when a Simulation is made, not from block to block
    bool chain() const noexcept { return chain_velocities || chain_displacements; }
};

/// A block of samples; sized once, filled by Simulation::advance().
struct Samples {
    /// @param most what advance() may ever be asked to put here @param capacity samples
    Samples(const Chain& chain, std::size_t capacity, Wish most);
    /// The same without a chain. @param plate whether there is room for v_plate
    Samples(std::size_t spheres, bool plate, std::size_t capacity, Wish most);

    std::int64_t first = 0;  ///< index of the first sample since the start
    std::size_t count = 0;   ///< samples in this block
    std::size_t capacity = 0;
    std::size_t spheres = 0;
    Wish holds;                   ///< which of the columns are filled
    std::vector<double> v_last;   ///< velocity of the last sphere [m/s], [sample]
    std::vector<double> v_plate;  ///< of the plate [m/s], [sample]; empty without a plate
    std::vector<double> v_out;    ///< into the medium [m/s], [sample]
    std::vector<double> chain_v;  ///< [m/s], [sample][sphere]
    std::vector<double> chain_x;  ///< [m], [sample][sphere]
};

/// A moment counted in steps, as a fixed-point number with 64 bits behind the point. Adding the sample period
/// again and again is exact, so the moment of a sample does not drift: after 1e12 samples it is off by 5e-8
/// steps.
struct StepPosition {
    std::int64_t step = 0;
    std::uint64_t part = 0;  ///< of the step, in units of 2^-64

    static StepPosition of(double steps) noexcept;
    double fraction() const noexcept { return static_cast<double>(part >> 11U) * 0x1p-53; }
    void advance(StepPosition by) noexcept {
        part += by.part;
        step += by.step + (part < by.part ? 1 : 0);
    }
    /// n times this one, from 0.
    StepPosition times(std::int64_t n) const noexcept;
};

}  // namespace hertzline
