#pragma once
// A search at work: a study whose points come one batch after another. Resumed, it asks for the same points again and finds their rows in
// the journal.

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "studies/optimise/search.hpp"
#include "studies/sweep/journal.hpp"
#include "studies/sweep/sweep.hpp"
#include "studies/sweep/workers.hpp"

namespace hertzline::studies {

struct SearchRequest {
    Scene base;
    std::vector<Axis> axes;  ///< ranges without a count, and lists
    Goal goal;
    std::int64_t evaluations = 0;  ///< at least fewest_evaluations()
    std::uint64_t seed = 0;
    PointDemand demand;  ///< its columns have the measures of the goal
    std::int64_t after =
        0;  ///< evaluations of an earlier search, which this one goes on from: the first rows of the journal
};

/// The search as a study of no points yet.
Sweep study_of(const SearchRequest& request);

class SearchJob {
public:
    /// @param journal loaded, with room for all evaluations, and with the rows of an earlier search; outlives this
    SearchJob(SearchRequest request, Journal& journal, int jobs, const std::atomic<bool>& stop,
              std::function<void(std::int64_t evaluations)> progress);

    /// Searches to the end, or until `stop` is set (evaluations().stopped()).
    /// @throws std::runtime_error when the journal cannot be written, or the machine lacks what a point needs
    void run();

    const SearchRequest& request() const noexcept { return request_; }
    const SearchSpace& space() const noexcept { return space_; }
    const Evaluations& evaluations() const noexcept { return evaluations_; }
    const SearchResult& result() const noexcept { return result_; }
    /// Points by status, of all evaluations.
    const PointCounts& counts() const noexcept { return counts_; }

    /// The evaluations as a study, in their order; complete once run() has returned.
    const Sweep& sweep() const noexcept { return sweep_; }
    PointResult row(std::int64_t evaluation) const;

private:
    void take_earlier();
    Score score_of(std::int64_t point);
    std::optional<std::vector<Score>> evaluate(std::span<const std::vector<SceneValue>> points);

    SearchRequest request_;
    Journal& journal_;
    int jobs_;
    const std::atomic<bool>& stop_;
    std::function<void(std::int64_t evaluations)> progress_;
    SearchSpace space_;
    Judge judge_;
    Sweep sweep_;
    Evaluations evaluations_;
    SearchResult result_;
    PointCounts counts_;
};

}  // namespace hertzline::studies
