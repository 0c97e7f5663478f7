#include "apps/commands/sweep/sweep_crew.hpp"

#include <fmt/format.h>

#include "apps/console/signals.hpp"

namespace hertzline::app {

void ThreadCrew::muster(const SweepOptions& options, const stream::Sweep& /*sweep*/) {
    threads_ = jobs_of(options);
}

std::string ThreadCrew::text() const {
    return fmt::format("{} {}", threads_, threads_ == 1 ? "thread" : "threads");
}

stream::PointCounts ThreadCrew::run(const stream::Sweep& sweep, stream::Journal& journal,
                                    std::span<const std::int64_t> points, const News& news) {
    return stream::run_points(sweep, journal, points, threads_, stop_asked(), news);
}

}  // namespace hertzline::app
