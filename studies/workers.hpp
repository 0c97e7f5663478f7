#pragma once
// Runs the points of a study on several threads, each with its own runner, and puts their rows into the journal.

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>

#include "studies/journal.hpp"
#include "studies/study.hpp"

namespace hertzline::studies {

/// Points by status.
struct PointCounts {
    std::array<std::int64_t, point_status_words.size()> of_status{};

    std::int64_t& operator[](PointStatus status) { return of_status[static_cast<std::size_t>(status)]; }
    std::int64_t operator[](PointStatus status) const { return of_status[static_cast<std::size_t>(status)]; }
    PointCounts& operator+=(const PointCounts& more) noexcept;
    std::int64_t all() const noexcept;
    /// Returns the counts of points that are not ok, "3 refused, 1 unstable"; empty when all are.
    std::string faults() const;
};

/// Returns the threads of a study that asks for none: one for each processor that this process may use.
int usual_jobs();

/// Returns the fault of a number of threads.
std::optional<std::string> jobs_fault(int jobs);

/// Called a few times a second with the finished points.
using OnProgress = std::function<void(const PointCounts&)>;

/// Runs the points in their order as threads become free. Returns early when `stop` is set; unfinished points have no row.
/// @param journal loaded; rows are committed a few times a second, the last ones by the caller @param progress called by this thread
/// @throws std::runtime_error when the journal cannot be written; committed rows stay in it
PointCounts run_points(const Study& study, Journal& journal, std::span<const std::int64_t> points, int jobs,
                       const std::atomic<bool>& stop, const OnProgress& progress);

}  // namespace hertzline::studies
