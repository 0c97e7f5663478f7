#pragma once
// How far a sweep is: a line on a terminal that is written over, elsewhere a message every few seconds.

#include <chrono>
#include <cstdint>
#include <string>

#include "studies/sweep/workers.hpp"

#include "apps/console/progress.hpp"

namespace hertzline::app {

/// " 42 %  420 of 1000 points, 251 points/s, 2.31 s left; 3 refused"
std::string sweep_progress_text(const studies::PointCounts& done, std::int64_t all, double elapsed_s);

class SweepProgress {
public:
    /// @param all points that are to be run
    explicit SweepProgress(std::int64_t all);

    void tell(const studies::PointCounts& done);

    /// Since it was made [s].
    double elapsed_s() const;

private:
    using Clock = std::chrono::steady_clock;

    std::int64_t all_;
    bool terminal_;
    ProgressLine line_;
    Clock::time_point start_ = Clock::now();
    Clock::time_point told_ = start_;
};

}  // namespace hertzline::app
