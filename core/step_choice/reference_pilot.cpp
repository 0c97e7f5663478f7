#include "core/step_choice/reference_pilot.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "core/integrators/stability.hpp"
#include "core/solvers/series_solver.hpp"
#include "core/step_choice/step_advice.hpp"

namespace hertzline {

namespace {

constexpr Integrator reference_integrator = Integrator::taylor12;
constexpr double as_good_as_exact = 1e-13;  // error of a piece
constexpr double own_share = 1e-3;          // of the accuracy: errors of pieces add up
constexpr double series_drive_periods = 0.11;

// How long pilots watch, in pieces of the reference, and in pieces times bodies.
struct Budget {
    double pieces;
    double body_pieces;
    double seconds(double piece_s, double bodies) const noexcept {
        return piece_s * std::min(pieces, body_pieces / bodies);
    }
};
constexpr Budget for_bursts{30e3, 1e6};  // burst, way and periods
constexpr Budget for_ringing{5e3, 2e5};  // the ring-down
constexpr Budget for_run{30e3, 1e6};     // the run over which the error is estimated

// Pieces times bodies that a reference takes at most, where contacts that open and close make its pieces shorter than foreseen. With
// its second run and the trials that is about a second.
constexpr double most_body_pieces = 2e6;
constexpr double most_body_pieces_of_run = 4e6;  // until the end of the estimate

constexpr double rung_down = 0.01;         // of the largest energy
constexpr double max_values = 2e6;         // in a pilot
constexpr double hopeless = 10;            // of the accuracy: a trial with such an error is not completed
constexpr double samples_per_period = 16;  // at least
constexpr std::size_t min_samples = 16;

/// The period of the drive, or of the fastest oscillation where there is no horn [s].
double watched_period_s(const Scene& scene, const Chain& chain) {
    if (scene.drive.kind != DriveKind::none) {
        return 1 / highest_frequency_hz(scene.drive);
    }
    const double omega = fastest_frequency(chain, expected_overlaps(chain, scene.drive));
    return omega > 0 ? 2 * std::numbers::pi / omega : scene.output.duration_s;
}

/// The burst and the wave's way, a half more since waves are slower than the stiffest contacts; or two bursts' periods [s].
double burst_and_way_s(const Scene& scene, const Chain& chain) {
    const Drive& drive = scene.drive;
    const double omega = fastest_frequency(chain, expected_overlaps(chain, drive));
    const double way_s = omega > 0 ? 2 / omega * static_cast<double>(chain.spheres()) : 0;
    const double burst_s = drive.kind != DriveKind::none ? drive.start_s + burst_duration_s(drive)
                                                         : watched_period_s(scene, chain);
    const double first_s = 1.5 * (burst_s + way_s);
    return drive.repetition_hz > 0 ? std::max(first_s, 2 / drive.repetition_hz) : first_s;
}

/// Sampled as the scene is, so that samples beside a contact's switching count as they will; else at a whole part or multiple of its
/// rate, on which the same steps fall.
Scene sampled_for(Scene scene, double period_s, double watched_s) {
    const double columns = static_cast<double>(scene.chain.spheres) + 2;
    double& rate = scene.output.sample_rate_hz;
    const double affordable = max_values / columns / watched_s;
    const double needed =
        std::max(samples_per_period / period_s, static_cast<double>(min_samples) / watched_s);
    const double wanted = std::max(std::min(rate, affordable), needed);
    rate = wanted < rate ? rate / std::floor(rate / wanted) : rate * std::ceil(wanted / rate);
    return scene;
}

/// Kinetic energy of the spheres, summed over some samples; in no unit.
double kinetic(const Pilot& pilot, std::size_t from, std::size_t to) noexcept {
    double sum = 0;
    for (std::size_t i = from; i < to; ++i) {
        const double* const v = pilot.row(i);
        for (std::size_t s = 0; s < pilot.spheres(); ++s) {
            sum += v[s] * v[s];
        }
    }
    return sum;
}

}  // namespace

double with_safety_factor(double own_error) noexcept {
    return own_error > amplified_rounding ? std::min(10 * own_error, std::max(1.0, own_error)) : own_error;
}

double part_of_period_s(const Drive& drive, double part) {
    constexpr double without_horn_s = 1;
    return drive.kind != DriveKind::none ? part / highest_frequency_hz(drive) : without_horn_s;
}

double longest_for_drive(const Drive& drive) {
    return part_of_period_s(drive, series_drive_periods);
}

double piece_error_for(double accuracy) noexcept {
    return std::clamp(own_share * accuracy, finest_piece_error, as_good_as_exact);
}

double step_of_reference(const Scene& scene, const Chain& chain, double piece_error) {
    const Eigen::ArrayXd overlaps = expected_overlaps(chain, scene.drive);
    const double omega = fastest_frequency(chain, overlaps);
    return std::min({SeriesSolver::phase_for(piece_error) / omega, longest_for_drive(scene.drive),
                     0.98 * largest_stable_step(chain, overlaps, reference_integrator)});
}

Scene shortened(Scene scene) {
    scene.chain.spheres = std::min(scene.chain.spheres, pilot_spheres);
    scene.chain.impact_spheres = std::min(scene.chain.impact_spheres, scene.chain.spheres);
    return without_sleep(std::move(scene));
}

ReferencePilot::ReferencePilot(const Scene& scene, double accuracy, double piece_error,
                               const std::atomic<bool>* stop)
    : ReferencePilot(scene, accuracy, piece_error, Chain(shortened(scene)), stop) {}

ReferencePilot::ReferencePilot(const Scene& scene, double accuracy, double piece_error, const Chain& chain,
                               const std::atomic<bool>* stop)
    : accuracy_(accuracy),
      stop_(stop),
      step_s_(step_of_reference(scene, chain, piece_error)),
      watched_s_(std::min(burst_and_way_s(scene, chain),
                          for_bursts.seconds(step_s_, static_cast<double>(chain.bodies())))),
      period_s_(watched_period_s(scene, chain)),
      scene_(sampled_for(shortened(scene), period_s_, watched_s_)),
      motion_(with_another_fit(scene_, accuracy_), reference_integrator, step_s_, stop),
      finer_(with_another_fit(scene_, accuracy_), reference_integrator, finer * step_s_, stop),
      shortened_(scene.chain.spheres > pilot_spheres),
      same_samples_(!shortened_ && scene_.output.sample_rate_hz == scene.output.sample_rate_hz) {
    motion_.run_to(samples_in(watched_s_), most_body_pieces);
    if (scene.drive.repetition_hz == 0) {
        ring_down();
    }
    peak_overlap_ = motion_.peak_overlap();
    finer_.run_to(motion_.samples());
    watched_ = motion_.stable() && finer_.stable() ? motion_.samples() : 0;
    judged_ = watched_;
    judged_error_ = watched_error_ = with_safety_factor(own_error(watched_).of_any);
    // the longest stretch that it can judge, or else the one that it knows best: the first samples are small, and rounding is large there
    const double good_enough = std::max(accuracy / 2, amplified_rounding / 10);
    for (std::size_t samples = watched_; judged_error_ > good_enough && samples > min_samples;) {
        samples = std::max(min_samples, samples * 7 / 8);
        const double error = with_safety_factor(own_error(samples).of_any);
        if (error < judged_error_) {
            judged_ = samples;
            judged_error_ = error;
        }
    }
}

std::size_t ReferencePilot::samples_in(double time_s) const noexcept {
    return std::max(min_samples, static_cast<std::size_t>(std::ceil(time_s * scene_.output.sample_rate_hz)));
}

/// Goes on until the spheres have a hundredth of the kinetic energy that they had at most, by drive periods.
void ReferencePilot::ring_down() {
    const std::size_t period = std::min(samples_in(period_s_), motion_.samples());
    const double affordable = for_ringing.seconds(step_s_, static_cast<double>(motion_.spheres() + 1));
    constexpr double of_free_flight =
        10;  // of the stretch: spheres that meet nothing any more take endless pieces
    const double ringing_s =
        scene_.drive.kind != DriveKind::none ? affordable : std::min(affordable, of_free_flight * watched_s_);
    const std::size_t most = motion_.samples() + samples_in(ringing_s);
    if (period == 0) {
        return;  // it has failed at once
    }
    double largest = 0;
    for (std::size_t from = 0; from + period <= motion_.samples(); from += period) {
        largest = std::max(largest, kinetic(motion_, from, from + period));
    }
    for (std::size_t before = 0;
         motion_.stable() && before < motion_.samples() && motion_.samples() < most &&
         kinetic(motion_, motion_.samples() - period, motion_.samples()) > rung_down * largest;) {
        before = motion_.samples();
        motion_.run_to(std::min(before + period, most), most_body_pieces);
    }
}

Difference ReferencePilot::own_error(std::size_t samples) const {
    return difference(finer_, motion_, samples);
}

/// Pilots that take the samples of the run show such an error where it happens, and failed ones show nothing.
WrongSides ReferencePilot::unseen_wrong_sides(const Pilot& pilot, std::size_t samples,
                                              const Difference& found) const noexcept {
    return same_samples_ || !std::isfinite(found.of_any)
               ? WrongSides{}
               : wrong_sides(pilot, motion_, samples, accuracy_ * found.loudness);
}

bool ReferencePilot::needs_finer_fit() {
    constexpr double share = 0.3;  // of the accuracy
    if (!provides(scene_, Requires::modal_plate) || scene_.numerics.poles == motion_.poles()) {
        return false;
    }
    const double found = trial(reference_integrator, step_s_).error;
    const double of_response = pole_error(scene_);
    if (std::isfinite(found) && of_response > 0) {
        fit_amplification_ = std::max(1.0, found / of_response);
    }
    return !(found <= std::max(share * accuracy_, judged_error_));
}

void ReferencePilot::take_finer_fit() {
    scene_ = with_another_fit(std::move(scene_), accuracy_);
    other_fit_.emplace(with_another_fit(scene_, accuracy_), reference_integrator, step_s_, stop_);
}

Trial ReferencePilot::trial(Integrator integrator, double step_s, double rest_tolerance) {
    Scene scene = scene_;
    scene.numerics.rest_tolerance = rest_tolerance;
    Trial result{Pilot(scene, integrator, step_s, stop_), step_s};
    if (judged_ == 0) {
        result.error = std::numeric_limits<double>::infinity();
        return result;
    }
    Pilot& pilot = result.pilot;
    const auto fly = [&](std::size_t samples) {
        pilot.run_to(samples);
        result.steps_per_s =
            static_cast<double>(pilot.steps()) * pilot.sample_rate_hz() / static_cast<double>(samples);
        return difference(pilot, motion_, samples, judged_);
    };
    // A trial with such an error in the first quarter has at least as large a one in all.
    const std::size_t quarter = std::max<std::size_t>(1, judged_ / 4);
    result.error = fly(quarter).of_any;
    if (result.error <= hopeless * accuracy_) {
        const Difference found = fly(judged_);
        result.error = std::max(found.of_any, judged_error_);
        result.wrong_sides = unseen_wrong_sides(pilot, judged_, found).count;
    }
    steps_of_trials_ += pilot.steps();
    return result;
}

double ReferencePilot::body_steps() const {
    const std::int64_t of_other_fit = other_fit_ ? other_fit_->steps() : 0;
    return static_cast<double>(motion_.steps() + finer_.steps() + of_other_fit + steps_of_trials_) *
           static_cast<double>(spheres() + 1);
}

std::optional<Trial> ReferencePilot::affordable_trial(Integrator integrator, double step_s,
                                                      double rest_tolerance) {
    return duration_s() <= affordable_s(step_s) ? std::optional(trial(integrator, step_s, rest_tolerance))
                                                : std::nullopt;
}

double ReferencePilot::affordable_s(double step_s) const noexcept {
    return affordable_body_steps * step_s / static_cast<double>(scene_.chain.spheres + 1);
}

ErrorEstimate ReferencePilot::estimate(Trial& trial, std::optional<double> run_s) {
    const double bodies = static_cast<double>(scene_.chain.spheres) + 1;
    const double rate = scene_.output.sample_rate_hz;
    const double watched_s = static_cast<double>(watched_) / rate;
    const double longest_s = std::min(for_run.seconds(step_s_, bodies), max_values / (bodies + 1) / rate);
    const double over_s =
        std::min({run_s.value_or(watched_s), std::max(watched_s, longest_s), affordable_s(trial.step_s)});
    motion_.run_to(samples_in(over_s), most_body_pieces_of_run);
    // a reference that has failed shows nothing, one that has taken all its pieces ends early
    const std::size_t samples =
        motion_.stable() ? std::min(samples_in(over_s), motion_.samples()) : samples_in(over_s);
    finer_.run_to(samples);
    trial.pilot.run_to(samples);
    // the outputs of a chain that was shortened are not its own
    const auto of_run = shortened_ ? &Difference::of_any : &Difference::of_output;
    const double own = own_error(samples).*of_run;
    const bool amplifies = own > amplified_rounding;
    double of_fit = 0;
    if (other_fit_) {
        other_fit_->run_to(samples);
        of_fit = difference(*other_fit_, motion_, samples).*of_run;
    }
    const Difference found = difference(trial.pilot, motion_, samples);
    const WrongSides wrong = unseen_wrong_sides(trial.pilot, samples, found);
    constexpr double improbable = 0.005;  // samples on the wrong side
    const bool by_chance = !amplifies && wrong.count > improbable && found.loudness > 0;
    const double beside = by_chance ? wrong.norm / found.loudness : 0;
    return {.error = std::max({found.*of_run, beside, with_safety_factor(own)}) + of_fit,
            .over_s = static_cast<double>(samples) / rate,
            .amplifies = amplifies,
            .of_fit = of_fit};
}

}  // namespace hertzline
