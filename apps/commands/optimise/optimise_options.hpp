#pragma once
// The options of `hertzline optimise`, and the search that follows from them.

#include <cstdint>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "apps/commands/sweep/sweep_options.hpp"
#include "studies/search_job.hpp"

namespace hertzline::app {

struct OptimiseOptions {
    SweepOptions sweep;    ///< the options that a sweep has, too; the others keep their defaults
    std::string maximise;  ///< a measure; empty: none
    std::string minimise;  ///< a measure; empty: none
    std::vector<std::string> subject_to;
    std::int64_t evaluations = 2000;
    std::uint64_t seed = 1;
};

/// Adds all options. @param options outlive the parsing
void add_optimise_options(CLI::App& app, OptimiseOptions& options);

/// A search that can run.
struct ValidatedSearch {
    studies::SearchRequest request;
    studies::PlanSummary summary;  ///< of points all over the ranges
};

/// Checks the options. @throws WrongUse with every fault
ValidatedSearch validated_search(const OptimiseOptions& options);

}  // namespace hertzline::app
