#pragma once
// What a search tells when it has ended: the best point, how sure it is, and what lies around it.

#include <string>
#include <vector>

#include "measures/quantities.hpp"
#include "studies/optimise/search_job.hpp"

#include "core/scene/json.hpp"

namespace hertzline::studies {

/// The summary. @param files one or several that have the rows
std::vector<measures::SummaryGroup> search_summary(const SearchJob& job, const Json& files);

/// What is to be warned of: a best point on an edge, or that one local search alone came to.
measures::Warnings search_warnings(const SearchJob& job);

/// Why there is no best point: how far the closest one is from the constraints.
std::string no_feasible_text(const SearchJob& job);

}  // namespace hertzline::studies
