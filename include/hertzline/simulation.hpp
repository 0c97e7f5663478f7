#pragma once
// A scene, simulated sample by sample. run.hpp simulates one from its start to its end and measures it.

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>

#include "hertzline/ledger.hpp"
#include "hertzline/samples.hpp"
#include "hertzline/scene.hpp"
#include "hertzline/taps.hpp"

namespace hertzline {

struct Chain;
struct ChainState;
class PiecewiseMotion;
class Solver;

/// State of the integration.
// clang-format off
enum class [[nodiscard]] Status {
    running,
    unstable,
    stopped,  ///< as SimulationOptions asked
};
// clang-format on

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
    /// The motion of a live drive, unless the scene has its samples.
    std::shared_ptr<const PiecewiseMotion> live = nullptr;
    /// That work on the chains of an array, side by side. The samples are the same with any number.
    std::size_t threads = 1;
    /// The water between discs is worked out in intervals that are this part of the usual ones.
    double water_part = 1;
    /// It is stopped after this number of steps or pieces, too.
    std::int64_t max_steps = std::numeric_limits<std::int64_t>::max();

    /// @param steps taken so far
    bool stop_asked(std::int64_t steps) const noexcept {
        return steps >= max_steps || (stop != nullptr && stop->load(std::memory_order_relaxed));
    }
};

/// How far a motion has gone from its start to some moment.
struct MotionExtremes {
    double time_s = 0;                ///< the moment [s]
    double largest_press_m = 0;       ///< largest overlap of any contact so far, beyond that at rest [m]
    double last_press_m = 0;          ///< the same of the last contact [m]
    std::int64_t contact_events = 0;  ///< openings and closings so far
    double energy_residual = 0;       ///< as Simulation::energy_residual()
};

/// Horn - sphere, sphere - sphere and sphere - end.
inline constexpr std::size_t contact_kinds = 3;

/// The largest loads of the contacts, each number of the contact where it is largest.
struct ContactLoad {
    double force_n = 0;        ///< elastic force [N]
    double pressure_pa = 0;    ///< at the centre of the contact [Pa]
    double overlap_ratio = 0;  ///< overlap over the radius of a sphere
    std::array<double, contact_kinds>
        pressures_pa{};  ///< of each kind of contact [Pa]; 0 where there is none
};

/// A scene in motion. Owns all that it needs; not for several threads at once.
class Simulation {
public:
    /// Takes a Resolution of resolve(), too. @throws std::bad_alloc @throws std::invalid_argument where a grid is to integrate a modal
    /// plate or a law of damping other than the dashpot, which validate() refuses
    explicit Simulation(ResolvedScene scene, const SimulationOptions& options = {});
    ~Simulation();
    Simulation(Simulation&&) noexcept;
    Simulation& operator=(Simulation&&) noexcept;

    /// A block for advance(), with room for all taps of the options. @throws std::bad_alloc
    Samples make_samples(std::size_t capacity) const;

    /// Back to sample 0, at static equilibrium.
    void reset() noexcept;

    /// From here on the first sample has this number instead of 0; for a simulation that has not begun.
    void begin_at(std::int64_t sample) noexcept { first_sample_ = sample; }

    // One simulation after another in the same run: end_at() sets the end of the first one, which gives all samples before and hands its
    // motion over. Both drives restart their bursts at the first sample of the second.

    /// Whether the motion of a scene can be handed over to one with another drive: that of a series, and that of a grid whose steps
    /// divide the sample period. @param scene with integrator and step
    static bool can_hand_over(const ResolvedScene& scene) noexcept;
    /// The first sample at which end_at() can let it end: the motion has not gone further.
    std::int64_t first_open_sample() const noexcept;
    /// The motion will end at this sample, which belongs to the simulation that follows: advance() gives those before it, and must not be
    /// asked for more. @param sample first_open_sample() or later
    void end_at(std::int64_t sample) noexcept;
    /// Begins at sample `first`, where `before` ends, with its motion and account of energy. Allocates nothing.
    /// @param before can_hand_over(); has the same taps; its scene differs in drive and step only; has given all samples before `first`
    /// @returns the status of `before` at its end, whose failure() tells more; unstable where the taps differ
    Status continue_from(Simulation& before, std::int64_t first) noexcept;

    /// The next `count` samples (at most the block's capacity) of the wanted taps for which the block has room and that the options name;
    /// `holds` tells which. A tap for which it has another number of channels is none of them. Allocates nothing. If
    /// the step turns out to lie beyond the stability limit the block comes back empty, and failure() names place and time. In an array a
    /// tap that was not wanted before may be missing, which the block's `holds` says, for as long as an element is later than others.
    Status advance(Samples& samples, std::size_t count, TapSet wanted) noexcept;
    /// The same for all taps of the block.
    Status advance(Samples& samples, std::size_t count) noexcept {
        return advance(samples, count, samples.taps());
    }

    /// Passes over the next `count` samples: the motion continues, nothing is written.
    Status skip(std::int64_t count) noexcept;

    const Scene& scene() const noexcept { return scene_.scene(); }  ///< with integrator and step
    TapSet taps() const noexcept { return options_.taps; }
    /// How many chains there are: the elements of an array, or 1.
    std::size_t elements() const noexcept;
    const Chain& chain(std::size_t element = 0) const noexcept;
    /// Step of a grid, or the longest piece of a series [s].
    double step_s() const noexcept { return step_s_; }
    /// Steps or pieces so far.
    std::int64_t steps() const noexcept;
    std::int64_t next_sample() const noexcept;
    std::int64_t contact_events() const noexcept;

    /// State at the last step taken. Not cheap: for tests, checks and ledgers, not for each sample.
    const ChainState& state(std::size_t element = 0) noexcept;
    /// Its time since the simulation's first sample [s]. Steps do not end where samples lie.
    double time_s() const noexcept;
    Ledger ledger() noexcept;
    /// Energy that no entry of the ledger accounts for, |kinetic + stored - start - work + lost + holder_lost + passed| [J].
    double energy_missing() noexcept;
    /// The same relative to the largest of the horn's work back and forth, the losses and the kinetic energy.
    double energy_residual() noexcept;
    /// Error of the fit of modal plates' responses, which all steps share [relative].
    double fit_error() const noexcept;
    /// Takes a pass over the chain. Allocates nothing.
    MotionExtremes extremes() noexcept;

    /// Why the simulation failed, for a human; empty if it did not.
    std::string failure() const;

    /// Bytes that a simulation of this scene needs, roughly from above. @throws std::bad_alloc
    static double memory_bytes(const Scene& scene, TapSet taps);

private:
    ResolvedScene scene_;
    SimulationOptions options_;
    std::unique_ptr<const Chain> chain_;  ///< null: those of an array belong to its solver
    double step_s_;
    std::unique_ptr<Solver> solver_;
    std::int64_t first_sample_ = 0;
    Status status_ = Status::running;
    bool refused_ = false;  ///< continue_from() was given a simulation with other taps
};

}  // namespace hertzline
