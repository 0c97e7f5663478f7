#include "apps/commands/sweep/sweep_crew.hpp"

#include <fmt/format.h>

#include "apps/console/signals.hpp"

namespace hertzline::app {

void ThreadCrew::muster(const SweepOptions& options, const studies::Sweep& /*sweep*/) {
    threads_ = jobs_of(options);
}

std::string ThreadCrew::text() const {
    return fmt::format("{} {}", threads_, threads_ == 1 ? "thread" : "threads");
}

studies::PointCounts ThreadCrew::run(const studies::Sweep& sweep, studies::Journal& journal,
                                     std::span<const std::int64_t> points, const News& news) {
    return studies::run_points(sweep, journal, points, threads_, stop_asked(), news);
}

}  // namespace hertzline::app
