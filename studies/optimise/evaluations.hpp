#pragma once
// The points that a search has looked at: each once, in batches, no more than it may.

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "studies/optimise/goal.hpp"
#include "studies/optimise/search_space.hpp"

namespace hertzline::studies {

/// Runs points, and gives their scores in their order; nothing once the user stops it. Errors are exceptions.
using Evaluate =
    std::function<std::optional<std::vector<Score>>(std::span<const std::vector<SceneValue>> points)>;

class Evaluations {
public:
    struct Evaluation {
        std::vector<SceneValue> values;
        Score score;
        double merit = 0;  ///< merit_of()
    };

    /// @param budget evaluations that there may be
    Evaluations(bool maximise, std::int64_t budget, Evaluate evaluate);

    static constexpr std::int64_t none = -1;

    /// The numbers of these points, `none` where there is no budget left. Points that are new are evaluated as one batch.
    std::vector<std::int64_t> run(std::span<const std::vector<SceneValue>> points);

    /// Adds a point whose score is known.
    void add(std::vector<SceneValue> values, const Score& score);

    /// The number of a point; `none` when it was not looked at yet.
    std::int64_t find(const std::vector<SceneValue>& values) const;

    const Evaluation& operator[](std::int64_t number) const { return all_[static_cast<std::size_t>(number)]; }
    const std::vector<Evaluation>& all() const noexcept { return all_; }
    std::int64_t size() const noexcept { return static_cast<std::int64_t>(all_.size()); }
    std::int64_t left() const noexcept { return stopped_ ? 0 : budget_ - kept_back_ - size(); }
    /// So many of the budget are not to be used yet.
    void keep_back(std::int64_t evaluations) noexcept { kept_back_ = evaluations; }
    bool stopped() const noexcept { return stopped_; }

    /// The feasible one of the least merit, of several the first; `none` when there is none.
    std::int64_t best() const noexcept;

private:
    bool maximise_;
    std::int64_t budget_;
    std::int64_t kept_back_ = 0;
    Evaluate evaluate_;
    std::vector<Evaluation> all_;
    std::map<std::vector<SceneValue>, std::int64_t> numbers_;
    bool stopped_ = false;
};

}  // namespace hertzline::studies
