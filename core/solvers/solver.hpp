#pragma once
// The interface of the solvers, which integrate a chain for a Simulation: step by step on a grid (stepped_solver.hpp), or piece by piece as
// power series (series_solver.hpp).

#include <atomic>
#include <cstdint>
#include <limits>
#include <string>

#include "core/model/chain.hpp"
#include "core/model/energy.hpp"
#include "core/samples.hpp"
#include "core/scene/scene.hpp"

namespace hertzline {

/// Whether the integration still stands.
enum class Status {
    running,
    unstable,
    stopped,  ///< as SimulationOptions asked
};

/// Whether spheres ahead of the wavefront are left out. With leapfrog the samples are the same, to the last bit.
enum class WavefrontTracking {
    on,
    off,  ///< every sphere is worked on from the start: for tests and benchmarks
};

/// Whether work and losses are added up. Solvers on a grid always do: it costs them next to nothing.
enum class LedgerKeeping { on, off };

/// Purpose and limits of a simulation.
struct SimulationOptions {
    /// All taps that will be asked for; those that the scene lacks are left out.
    TapSet taps = TapSet(Tap::v_last) | Tap::v_plate | Tap::v_out;
    LedgerKeeping ledger = LedgerKeeping::on;
    WavefrontTracking tracking = WavefrontTracking::on;
    /// Once it is true, samples come to an end within a few steps, in the midst of a block. Unset: never.
    const std::atomic<bool>* stop = nullptr;
    /// It is stopped after this number of steps or pieces, too.
    std::int64_t max_steps = std::numeric_limits<std::int64_t>::max();

    /// @param steps taken so far
    bool stop_asked(std::int64_t steps) const noexcept {
        return steps >= max_steps || (stop != nullptr && stop->load(std::memory_order_relaxed));
    }
};

namespace kernels {
class PlateMotion;
}
class PlateOutputs;

/// The motion at the sample at which a solver was to end. Views of that solver, for the one that continues the motion.
struct Motion {
    std::int64_t sample;
    const ChainState& state;
    Eigen::Index moving;  ///< bodies from here on are at rest
    Ledger ledger;
    double horn_m;  ///< displacement of the horn [m]
    // of a series alone
    const double* overlaps = nullptr;  ///< of the contacts before the last piece, by slots of a SimdChain [m]
    const kernels::PlateMotion* plate = nullptr;  ///< null: there is no modal plate
    const PlateOutputs* sound = nullptr;          ///< on its way to the hydrophone
};

class Solver {
public:
    virtual ~Solver() = default;

    /// Back to sample 0, at static equilibrium.
    virtual void reset() noexcept = 0;

    /// Appends the next `count` samples; without a sink they are passed over. Allocates nothing.
    virtual Status produce(Samples* samples, std::int64_t count) noexcept = 0;

    virtual std::int64_t next_sample() const noexcept = 0;

    /// The first sample that the motion has not gone beyond: from here on end_at() can hold it.
    virtual std::int64_t first_open_sample() const noexcept = 0;
    /// No step or piece goes beyond the time of this sample, which is an open one.
    virtual void end_at(std::int64_t sample) noexcept = 0;
    /// Takes the motion to the sample of end_at(); all samples before have been given. Allocates nothing.
    virtual Status reach_end() noexcept = 0;
    /// The motion there. Valid while this solver is left alone.
    virtual Motion motion() noexcept = 0;
    /// Begins with another solver's motion, which becomes that of sample 0, and with its account of energy. Allocates nothing.
    /// @param motion of the same integrator and an equal chain, of a scene that Simulation::can_hand_over()
    virtual void begin_with(const Motion& motion) noexcept = 0;

    virtual std::int64_t contact_events() const noexcept = 0;

    /// State at the end of the last step, its time [s], and where the horn is then [m].
    virtual const ChainState& state() noexcept = 0;
    virtual double time_s() const noexcept = 0;
    virtual double horn_displacement() const noexcept = 0;
    virtual Ledger ledger() noexcept = 0;

    /// Why the integration failed, for a human.
    virtual std::string failure() const = 0;
};

}  // namespace hertzline
