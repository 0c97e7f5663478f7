#pragma once
// A scene computed as exactly as possible: the reference for pilots with longer steps.

#include <optional>

#include "core/model/chain.hpp"
#include "core/solvers/series_solver.hpp"
#include "core/step_choice/pilot.hpp"
#include "hertzline/resolve.hpp"

namespace hertzline {

/// A part of a period of the drive's highest frequency [s]; 1 s where there is no horn.
double part_of_period_s(const Drive& drive, double part);

/// The longest step that a series may take, whatever the chain does: the horn's series reaches that far [s].
double longest_for_drive(const Drive& drive);

/// The error of a piece of the reference that is as good as exact for such an accuracy.
double piece_error_for(double accuracy) noexcept;

/// Shorter pieces lose to rounding.
inline constexpr double finest_piece_error = 1e-15;

/// Longest piece of taylor12 with such an error, with a chain of the scene [s].
double step_of_reference(const Scene& scene, const Chain& chain, double piece_error);

/// The spheres of a long chain that pilots simulate.
inline constexpr std::int64_t pilot_spheres = SeriesSolver::judged_spheres;

/// The first spheres of a long chain.
Scene shortened(Scene scene);

/// An error of the reference itself above this is rounding that the motion amplifies [relative L2].
inline constexpr double amplified_rounding = 1e-8;

/// The error that a reference is said to have when two of different steps differ by so much: ten times that once rounding is
/// amplified, because a pair of such motions differs by chance. Motions that have nothing in common any more differ by about one.
double with_safety_factor(double own_error) noexcept;

/// No error is said to be below this: sums of rounding errors, which all pilots share, reach it [relative L2].
inline constexpr double least_error = 1e-12;

/// The pieces of the second reference, relative to those of the first.
inline constexpr double finer = 0.7;

/// A pilot with some step, and its error over the stretch on which steps are chosen.
struct Trial {
    Pilot pilot;
    double step_s = 0;
    /// Relative L2 of the worst velocity, at least the reference's; infinite if the pilot failed.
    double error = 0;
    /// Samples of v_out to be expected on the wrong side of a switching (pilot.hpp).
    double wrong_sides = 0;
    double steps_per_s = 0;  ///< steps or pieces in a simulated second
};

/// The stretch that it watches is a property of the scene, not of output.duration_s, so that runs of any length get the same step: the
/// burst, the wave's way along the chain and the time in which the motion rings down to a hundredth of its energy; of a burst that
/// repeats two periods. It is computed twice, the second time with shorter pieces, to know its own error: nothing can be shown to be
/// better than that.
class ReferencePilot {
public:
    static constexpr int pilots = 2;

    /// @param accuracy steps are chosen as far as the reference is good enough to judge it
    /// @param piece_error of the reference; laws of damping with a power below 1 may need less than others for the same error
    /// @param stop as of SimulationOptions, for this and all trials, whose results then mean nothing
    /// @throws std::bad_alloc
    ReferencePilot(const Scene& scene, double accuracy, double piece_error,
                   const std::atomic<bool>* stop = nullptr);
    ReferencePilot(const Scene& scene, double accuracy, const std::atomic<bool>* stop = nullptr)
        : ReferencePilot(scene, accuracy, piece_error_for(accuracy), stop) {}

    /// Whether the fit of the plate's response, by itself, costs too much of the accuracy: that of the reference is finer. Takes a trial.
    bool needs_finer_fit();
    /// The error of the motion over that of the response, as needs_finer_fit() has found it; at least 1.
    double fit_amplification() const noexcept { return fit_amplification_; }
    /// Trials have the reference's fit from now on. By how much another fit changes the motion is then a part of estimates.
    void take_finer_fit();

    /// A pilot with that step, compared with the reference. One that errs by far too much early is not completed: its error is then
    /// a lower bound. @param rest_tolerance as of a scene: the motion that sleep cuts off is part of the error. @throws std::bad_alloc
    Trial trial(Integrator integrator, double step_s, double rest_tolerance = 0);

    /// The same, or nothing if the pilot would take longer than about a second.
    std::optional<Trial> affordable_trial(Integrator integrator, double step_s, double rest_tolerance);

    /// The error of a trial's step over a run, or over as much of it as is affordable. @throws std::bad_alloc
    /// @param run_s length of the run; none: the stretch that was watched
    ErrorEstimate estimate(Trial& trial, std::optional<double> run_s);

    double step_s() const noexcept { return step_s_; }  ///< its longest piece
    /// Steps times bodies that it and its trials have taken.
    double body_steps() const;
    /// Its own error over the stretch on which steps are chosen, relative L2 of the worst velocity; no trial is better.
    double error() const noexcept { return judged_error_; }
    /// The same over all that it watches.
    double watched_error() const noexcept { return watched_error_; }
    std::size_t spheres() const noexcept { return motion_.spheres(); }
    /// Over which steps are chosen [s].
    double duration_s() const noexcept { return static_cast<double>(judged_) / motion_.sample_rate_hz(); }
    const Eigen::ArrayXd& peak_overlap() const noexcept { return peak_overlap_; }  ///< [m], contacts()

private:
    ReferencePilot(const Scene& scene, double accuracy, double piece_error, const Chain& chain,
                   const std::atomic<bool>* stop);

    void ring_down();
    std::size_t samples_in(double time_s) const noexcept;
    double affordable_s(double step_s) const noexcept;
    Difference own_error(std::size_t samples) const;
    WrongSides unseen_wrong_sides(const Pilot& pilot, std::size_t samples,
                                  const Difference& found) const noexcept;

    double accuracy_;
    const std::atomic<bool>* stop_;
    double step_s_;
    double watched_s_;  // without the ring-down
    double period_s_;   // by which the ring-down is watched
    Scene scene_;       // sampled as pilots are
    Pilot motion_;
    Pilot finer_;
    std::optional<Pilot> other_fit_;  // where trials have that of the reference
    Eigen::ArrayXd peak_overlap_;
    std::size_t watched_ = 0;   // samples; 0: the reference itself failed
    bool shortened_ = false;    // the chain is longer than the pilots'
    bool same_samples_ = true;  // the pilots' are those of the run
    double fit_amplification_ = 1;
    double watched_error_ = 0;  // of the reference over these,
    double judged_error_ = 0;   // and over:
    std::size_t judged_ = 0;    // the first of them, over which steps are chosen
    std::int64_t steps_of_trials_ = 0;
};

}  // namespace hertzline
