#pragma once
// A scene's first burst, computed as exactly as can be had: what pilots with longer steps are compared with.

#include <optional>

#include "core/step_choice/pilot.hpp"

namespace hertzline {

/// The longest step that a series may take, whatever the chain does: the horn's series reaches that far [s].
double longest_for_drive(const Drive& drive) noexcept;

/// The first spheres of a long chain, whose motion is decided near the horn.
Scene shortened(Scene scene);

/// What a pilot watches: a burst and, since the chain rings on, half of another [s].
double watched_s(const Drive& drive) noexcept;

/// What a pilot with some step showed.
struct Trial {
    double step_s = 0;
    double error = 0;  ///< relative L2 of the worst velocity, at least the reference's; infinite if the pilot
                       ///< was unstable
    double steps_per_s = 0;  ///< steps or pieces in a simulated second
};

/// Flies when it is made, and once more with shorter pieces, to know its own error: nothing can be shown to
/// be better than that. It is below 1e-9, unless the motion is chaotic.
class ReferencePilot {
public:
    static constexpr int pilots = 2;

    /// @throws std::bad_alloc
    explicit ReferencePilot(const Scene& scene);

    /// A pilot with that step, compared with the reference. @throws std::bad_alloc
    Trial trial(Integrator integrator, double step_s) const;

    /// The same, or nothing if the pilot would take longer than about a second.
    std::optional<Trial> affordable_trial(Integrator integrator, double step_s) const;

    double step_s() const noexcept { return step_s_; }  ///< its longest piece
    double error() const noexcept { return error_; }    ///< its own, relative L2
    double duration_s() const noexcept;
    const Eigen::ArrayXd& peak_overlap() const noexcept { return motion_.peak_overlap; }  ///< [m], contacts()

private:
    PilotPlan plan_;
    double step_s_;
    Pilot motion_;
    double error_;
};

}  // namespace hertzline
