#include "apps/commands/sweep/sweep_progress.hpp"

#include <cmath>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "apps/console/messages.hpp"

namespace hertzline::app {

namespace {
constexpr auto between_messages = std::chrono::seconds(10);
}  // namespace

std::string sweep_progress_text(const studies::PointCounts& done, std::int64_t all, double elapsed_s) {
    const auto points = static_cast<double>(done.all());
    const double rate = elapsed_s > 0 ? points / elapsed_s : 0;
    const double left = rate > 0 ? (static_cast<double>(all) - points) / rate : INFINITY;
    const std::string faults = done.faults();
    return fmt::format("{:3.0f} %  {} of {} points, {:.3g} points/s, {} left{}{}",
                       all > 0 ? 100 * points / static_cast<double>(all) : 100, done.all(), all, rate,
                       time_text(left), faults.empty() ? "" : "; ", faults);
}

SweepProgress::SweepProgress(std::int64_t all) : all_(all), terminal_(stderr_is_terminal()) {}

double SweepProgress::elapsed_s() const {
    return std::chrono::duration<double>(Clock::now() - start_).count();
}

void SweepProgress::tell(const studies::PointCounts& done) {
    if (line_.due()) {
        line_.show(sweep_progress_text(done, all_, elapsed_s()));
    }
    if (!terminal_ && Clock::now() - told_ >= between_messages) {
        spdlog::info(sweep_progress_text(done, all_, elapsed_s()));
        told_ = Clock::now();
    }
}

}  // namespace hertzline::app
