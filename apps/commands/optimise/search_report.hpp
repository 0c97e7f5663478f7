#pragma once
// What a search tells when it has ended: the best point, how sure it is, and what lies around it.

#include <string>
#include <vector>

#include "stream/measures/run_summary.hpp"
#include "stream/optimise/search_job.hpp"

namespace hertzline::app {

/// The summary. @param files one or several that have the rows
std::vector<stream::SummaryGroup> search_summary(const stream::SearchJob& job,
                                                 const nlohmann::ordered_json& files);

/// What is to be warned of: a best point on an edge, or that one local search alone came to.
stream::Warnings search_warnings(const stream::SearchJob& job);

/// Why there is no best point: how far the closest one is from the constraints.
std::string no_feasible_text(const stream::SearchJob& job);

}  // namespace hertzline::app
