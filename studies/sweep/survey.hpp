#pragma once
// What is found out about the points of a sweep before the first of them is run.

#include <cstdint>
#include <string>

#include "measures/run.hpp"
#include "studies/sweep/plan.hpp"

#include "core/taps.hpp"

namespace hertzline::studies {

/// What the points are, all together.
struct SweepSurvey {
    std::int64_t refused = 0;   ///< points whose scene is refused: rows without numbers
    std::string first_refused;  ///< which one, and why
    double memory_bytes = 0;    ///< of the largest point, without its waveform
    TapSet taps;                ///< that any of them has
    bool modal = false;         ///< any of them has a modal plate
    double rows = 0;            ///< of the longest

    /// The taps of one channel that some point has; all there are when no point can be run.
    TapSet measurable() const noexcept {
        return taps.empty() ? measures::measurable_taps : taps & measures::measurable_taps;
    }
};

/// Looks at the scene of every point. @param measured beside v_out
SweepSurvey survey_of(const SweepPlan& plan, TapSet measured);

}  // namespace hertzline::studies
