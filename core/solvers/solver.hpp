#pragma once
// What integrates a chain for a Simulation: step by step on a grid (stepped_solver.hpp), or piece by piece as
// power series (series_solver.hpp).

#include <atomic>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>

#include "core/model/energy.hpp"
#include "core/model/state.hpp"
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

/// What a simulation is made for.
struct SimulationOptions {
    /// All that will ever be asked for; what the scene lacks is left out.
    TapSet taps = TapSet(Tap::v_last) | Tap::v_plate | Tap::v_out;
    LedgerKeeping ledger = LedgerKeeping::on;
    WavefrontTracking tracking = WavefrontTracking::on;
    /// Once it is true, samples come to an end within a few steps, in the midst of a block. Unset: never.
    const std::atomic<bool>* stop = nullptr;
    /// After so many steps or pieces it is stopped, too.
    std::int64_t max_steps = std::numeric_limits<std::int64_t>::max();

    /// @param steps taken so far
    bool stop_asked(std::int64_t steps) const noexcept {
        return steps >= max_steps || (stop != nullptr && stop->load(std::memory_order_relaxed));
    }
};

class Solver {
public:
    virtual ~Solver() = default;

    /// Back to sample 0, at static equilibrium.
    virtual void reset() noexcept = 0;

    /// Appends the next `count` samples; without a sink they are passed over. Allocates nothing.
    virtual Status produce(Samples* samples, std::int64_t count) noexcept = 0;

    /// The next samples of the wanted taps, in place of what the block held; at most its capacity. When the solver fails the block
    /// comes back empty. Allocates nothing.
    Status fill(Samples& samples, std::size_t count, TapSet wanted) noexcept;

    virtual std::int64_t next_sample() const noexcept = 0;

    /// The first sample that the motion has not gone beyond: from here on end_at() can hold it.
    virtual std::int64_t first_open_sample() const noexcept = 0;
    /// No step or piece goes beyond the time of this sample, which is an open one. For continue_from().
    virtual void end_at(std::int64_t sample) noexcept = 0;
    /// Its sample 0 becomes the moment at which another solver was to end, with the motion of that moment and the account of
    /// energy. That solver is done with. Allocates nothing. @param before of a scene that Simulation::can_hand_over(), same integrator, equal chain, has given
    /// all samples before its end
    /// @returns what has become of the other one
    virtual Status continue_from(Solver& before) noexcept = 0;

    virtual std::int64_t contact_events() const noexcept = 0;

    /// State at the end of the last step, its time [s], and where the horn is then [m].
    virtual const ChainState& state() noexcept = 0;
    virtual double time_s() const noexcept = 0;
    virtual double horn_displacement() const noexcept = 0;
    virtual Ledger ledger() noexcept = 0;

    /// What went wrong, for a human.
    virtual std::string failure() const = 0;
};

/// The solver for a resolved scene. @throws std::invalid_argument if integrator or step are not set; std::bad_alloc
std::unique_ptr<Solver> make_solver(const Scene& scene, const Chain& chain, const SimulationOptions& options);

/// Bytes that the solver for a scene needs, roughly from above.
double solver_bytes(const Scene& scene, TapSet taps) noexcept;

}  // namespace hertzline
