#pragma once
// The job of a search: a study whose points come one batch after another. A resumed search asks for the same points again and finds
// their rows in the journal.

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "studies/journal.hpp"
#include "studies/search.hpp"
#include "studies/study.hpp"
#include "studies/workers.hpp"

namespace hertzline::studies {

struct SearchRequest {
    Scene base;
    std::vector<Axis> axes;  ///< ranges without a count, and lists
    Goal goal;
    std::int64_t evaluations = 0;  ///< at least fewest_evaluations()
    std::uint64_t seed = 0;
    PointOptions options;    ///< its columns have the measures of the goal
    std::int64_t after = 0;  ///< evaluations of an earlier search, the first rows of the journal
    Json records = nullptr;  ///< varied_records(): as of its study
};

/// Returns the search as a study without points.
Study study_of(const SearchRequest& request);

class SearchJob {
public:
    /// @param journal loaded, with room for all evaluations, and with the rows of an earlier search; outlives this
    SearchJob(SearchRequest request, Journal& journal, int jobs, const std::atomic<bool>& stop,
              std::function<void(std::int64_t evaluations)> progress);

    /// Searches to the end, or until `stop` is set (evaluations().stopped()).
    /// @throws std::runtime_error when the journal cannot be written, or a point runs out of memory
    void run();

    const SearchRequest& request() const noexcept { return request_; }
    const SearchSpace& space() const noexcept { return space_; }
    const Evaluations& evaluations() const noexcept { return evaluations_; }
    const SearchResult& result() const noexcept { return result_; }
    /// All evaluations by status.
    const PointCounts& counts() const noexcept { return counts_; }

    /// The evaluations as a study, in their order; complete after run().
    const Study& study() const noexcept { return study_; }
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
    Study study_;
    Evaluations evaluations_;
    SearchResult result_;
    PointCounts counts_;
};

}  // namespace hertzline::studies
