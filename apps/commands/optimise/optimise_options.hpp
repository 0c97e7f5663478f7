#pragma once
// The options of `hertzline optimise`, and the search that they ask for.

#include <cstdint>
#include <string>
#include <vector>

#include "studies/optimise/search_job.hpp"
#include <CLI/CLI.hpp>

#include "apps/commands/sweep/sweep_options.hpp"

namespace hertzline::app {

struct OptimiseOptions {
    SweepOptions sweep;    ///< what a sweep has, too; the others are left as they are
    std::string maximise;  ///< a measure; empty: none
    std::string minimise;  ///< the same
    std::vector<std::string> subject_to;
    std::int64_t evaluations = 2000;
    std::uint64_t seed = 1;
};

/// @param options must outlive the parsing
void add_optimise_options(CLI::App& app, OptimiseOptions& options);

/// A search that can be begun.
struct SoundSearch {
    studies::SearchRequest request;
    studies::SweepSurvey survey;  ///< of points all over the ranges
};

/// @throws WrongUse that names every fault at once
SoundSearch sound_search(const OptimiseOptions& options);

}  // namespace hertzline::app
