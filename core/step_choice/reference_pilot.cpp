#include "core/step_choice/reference_pilot.hpp"

#include <algorithm>
#include <cmath>

#include "core/integrators/stability.hpp"
#include "core/solvers/series_solver.hpp"

namespace hertzline {

namespace {

constexpr Integrator best = Integrator::taylor12;
constexpr double as_good_as_exact = 1e-13;  // error of a piece
constexpr double finer = 0.7;               // pieces that show the error of the reference
constexpr double max_samples = 40e3;        // in a pilot,
constexpr double max_pieces = 20e3;         // and the longest pieces that it may last
constexpr double min_samples = 16;
constexpr double samples_per_period = 16;      // at least
constexpr double paper_bodies = 7;             // for which the samples are meant; more bodies, fewer samples
constexpr double affordable_body_steps = 1e7;  // about a second of a series, less of other methods
constexpr std::int64_t pilot_spheres = 128;
constexpr double bursts_watched = 1.5;
constexpr double series_drive_periods = 0.11;

double stable_step_expected(const Chain& chain, const Drive& drive) {
    return largest_stable_step(chain, expected_overlaps(chain, drive), best);
}

/// Sampled as the scene is, so that samples beside a contact's switching count as they will.
PilotPlan plan_for(const Scene& asked) {
    PilotPlan plan{shortened(asked), 0};
    const double longest_piece = stable_step_expected(Chain(plan.scene), asked.drive);
    const double watched = std::min(watched_s(asked.drive), max_pieces * longest_piece);
    const auto bodies = static_cast<double>(plan.scene.chain.spheres + 1);
    double& rate = plan.scene.output.sample_rate_hz;
    rate = std::max({std::min(rate, max_samples * paper_bodies / bodies / watched),
                     samples_per_period * asked.drive.frequency_hz, min_samples / watched});
    plan.samples = static_cast<std::size_t>(std::clamp(std::ceil(watched * rate), min_samples, max_samples));
    return plan;
}

double step_of_reference(const Scene& scene) {
    const Chain chain(scene);
    const double omega = fastest_frequency(chain, expected_overlaps(chain, scene.drive));
    return std::min({SeriesSolver::phase_for(as_good_as_exact) / omega, longest_for_drive(scene.drive),
                     0.98 * stable_step_expected(chain, scene.drive)});
}

}  // namespace

double longest_for_drive(const Drive& drive) noexcept {
    return series_drive_periods / drive.frequency_hz;
}

Scene shortened(Scene scene) {
    scene.chain.spheres = std::min(scene.chain.spheres, pilot_spheres);
    scene.numerics.rest_tolerance = 0;  // what that cuts off is no error of the step
    return scene;
}

double watched_s(const Drive& drive) noexcept {
    return bursts_watched * drive.cycles / drive.frequency_hz;
}

ReferencePilot::ReferencePilot(const Scene& scene)
    : plan_(plan_for(scene)),
      step_s_(step_of_reference(plan_.scene)),
      motion_(run_pilot(plan_, best, step_s_)),
      error_(largest_difference(run_pilot(plan_, best, finer * step_s_), motion_)) {}

double ReferencePilot::duration_s() const noexcept {
    return static_cast<double>(plan_.samples) / plan_.scene.output.sample_rate_hz;
}

Trial ReferencePilot::trial(Integrator integrator, double step_s) const {
    const Pilot pilot = run_pilot(plan_, integrator, step_s);
    return {step_s, std::max(largest_difference(pilot, motion_), error_),
            static_cast<double>(pilot.steps) / duration_s()};
}

std::optional<Trial> ReferencePilot::affordable_trial(Integrator integrator, double step_s) const {
    const auto bodies = static_cast<double>(plan_.scene.chain.spheres + 1);
    return bodies * duration_s() / step_s <= affordable_body_steps ? std::optional(trial(integrator, step_s))
                                                                   : std::nullopt;
}

}  // namespace hertzline
