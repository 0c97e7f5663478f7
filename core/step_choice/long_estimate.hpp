#pragma once
// The error of the step in use over a long stretch of the motion, longer and longer if need be. Pilots keep their samples; here only
// sums are kept, so that the stretch is bounded by time and not by memory.

#include <atomic>

#include "core/step_choice/output_errors.hpp"
#include "core/step_choice/pilot.hpp"
#include "core/step_choice/reference_pilot.hpp"
#include "core/step_choice/seen_motion.hpp"

namespace hertzline {

/// Simulates a scene three times side by side: with the step in use, and with two references as ReferencePilot has them.
class LongEstimate {
public:
    /// @param scene at most pilot_spheres long @param accuracy that its references are good enough to judge
    /// @param stop ends reach() within a few steps, if there is one. @throws std::bad_alloc
    LongEstimate(const ResolvedScene& scene, double accuracy, const std::atomic<bool>* stop);

    /// The longest stretch that is affordable: some seconds of a processor's time for each of the three [s].
    double longest_s() const noexcept { return longest_s_; }

    /// Goes on from where it is to that time, or as far as is affordable. @returns whether it got there: false when it was stopped,
    /// or one of the three failed
    bool reach(double time_s) noexcept;

    /// The error over the stretch so far.
    ErrorEstimate estimate() const noexcept;
    SeenMotion seen() noexcept;

private:
    double sample_rate_hz_;
    double reference_step_s_;
    double longest_s_;
    JudgedRun used_, reference_, finer_;
    EventRate event_rate_;
    OutputErrors errors_;      // of the step in use
    OutputErrors own_errors_;  // of the finer reference
};

}  // namespace hertzline
