#pragma once
// The error of a run without pilots: the same scene is simulated beside it with shorter steps. Their difference is the error of the
// longer ones, over all of the run. It costs a run and a third, where pilots cost some twenty, but is known only when the run is over.

#include <atomic>
#include <optional>

#include <Eigen/Core>

#include "core/model/chain.hpp"
#include "core/step_choice/output_errors.hpp"
#include "hertzline/resolve.hpp"
#include "hertzline/samples.hpp"
#include "hertzline/scene.hpp"

namespace hertzline {

/// How many steps are tried without pilots.
inline constexpr int max_tries = 3;

/// Chooses an integrator and a step that are likely to keep the accuracy, without an estimate or a largest stable step. Returns nothing
/// for scenes whose step has to be measured: a grid, a long chain, a step given by the scene, or a modal plate whose fit errs too much or
/// that has faults. @throws std::bad_alloc
std::optional<Resolution> resolve_unmeasured(const Scene& scene);

/// The next step to try. @param error of the last one. Nothing where no step helps
std::optional<Resolution> with_shorter_step(Resolution missed, double error) noexcept;

/// The next step to try where the run has pressed the contacts so far that its step lies beyond the stability limit, which resolve()
/// refuses. Nothing where it does not. @param peak_overlap of the run's contacts [m]
std::optional<Resolution> with_stable_step(Resolution tried, const Chain& chain,
                                           const Eigen::ArrayXd& peak_overlap);

/// A run's scene with shorter steps. Follows the run.
class FinerRun {
public:
    /// @param capacity of the run's blocks @param stop, max_steps as of SimulationOptions @param fit as of with_another_fit().
    /// @throws std::bad_alloc
    FinerRun(const ResolvedScene& scene, std::size_t capacity, const std::atomic<bool>* stop,
             std::int64_t max_steps = SimulationOptions{}.max_steps, std::size_t threads = 1,
             std::size_t fit = 0);

    /// Takes the run's next samples. @returns false when it failed or was stopped
    bool follow(const Samples& run) noexcept;

    /// The error of the run so far.
    ErrorEstimate estimate() const noexcept;
    /// Whether the run surely keeps the accuracy. Else its step is shortened, or pilots choose one.
    bool meets(double accuracy) const noexcept;

private:
    JudgedRun run_;
    OutputErrors errors_;
    std::size_t compared_ = 0;  // samples
};

/// An estimate, and the range of motion in which it holds.
struct RunEstimate {
    ErrorEstimate estimate;
    SeenMotion seen;
};

/// Simulates a run and a FinerRun beside it, two of an array without losses, as far as is affordable: some seconds of a processor's time
/// for each chain of an array.
/// @param stop ends it within a few steps. @throws std::bad_alloc
RunEstimate estimate_of_run(const ResolvedScene& scene, double run_s, const std::atomic<bool>* stop,
                            std::size_t threads = 1);

}  // namespace hertzline
