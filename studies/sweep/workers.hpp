#pragma once
// Runs the points of a study on several threads, each with a runner of its own, and puts their rows into the journal.

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <span>
#include <string>

#include "studies/sweep/journal.hpp"
#include "studies/sweep/sweep.hpp"

namespace hertzline::studies {

/// Points by status.
struct PointCounts {
    std::array<std::int64_t, point_status_words.size()> of_status{};

    std::int64_t& operator[](PointStatus status) { return of_status[static_cast<std::size_t>(status)]; }
    std::int64_t operator[](PointStatus status) const { return of_status[static_cast<std::size_t>(status)]; }
    PointCounts& operator+=(const PointCounts& more) noexcept;
    std::int64_t all() const noexcept;
    /// "3 refused, 1 unstable": those that are not ok; empty when all are.
    std::string faults() const;
};

/// Called a few times a second, with the points that have been run.
using OnProgress = std::function<void(const PointCounts&)>;

/// Runs the points, in that order as threads are free. Returns early when `stop` is set: what was not ended is missing in the journal.
/// @param journal loaded; rows are committed a few times a second, the last ones not yet @param progress called by this thread
/// @throws std::runtime_error when the journal cannot be written; what was committed is in it
PointCounts run_points(const Sweep& sweep, Journal& journal, std::span<const std::int64_t> points, int jobs,
                       const std::atomic<bool>& stop, const OnProgress& progress);

}  // namespace hertzline::studies
