#pragma once
// The report of a finished search: the best point, its neighbourhood, and how sure it is.

#include <string>
#include <vector>

#include "core/scene/json.hpp"
#include "measures/quantities.hpp"
#include "studies/search_job.hpp"

namespace hertzline::studies {

/// Returns the summary. @param files the value of its "file"
std::vector<measures::SummaryGroup> search_summary(const SearchJob& job, const Json& files);

/// Returns warnings: of a best point on an edge, or that only one local search reached.
Warnings search_warnings(const SearchJob& job);

/// Returns the reason why there is no best point: the distance of the closest one from the constraints.
std::string no_feasible_text(const SearchJob& job);

}  // namespace hertzline::studies
