#pragma once
// The goal of a search: a measure to be maximised or minimised, and bounds of others.

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <tl/expected.hpp>

#include "studies/point.hpp"

namespace hertzline::studies {

/// "peak_v_out_m_per_s >= 0.3"
struct Constraint {
    std::string measure;
    bool at_least = true;  ///< else at most
    double bound = 0;      ///< in the measure's unit

    /// Returns the canonical text.
    std::string text() const;
};

/// Reads "MEASURE >= NUMBER" or "MEASURE <= NUMBER". @returns the constraint, or a sentence without the option's name
tl::expected<Constraint, std::string> parse_constraint(std::string_view text);

struct Goal {
    std::string measure;
    bool maximise = true;
    std::vector<Constraint> constraints;
};

/// The score of a point.
struct Score {
    bool usable = false;    ///< it has all numbers of the goal, and they can be trusted: it is not chaotic
    bool feasible = false;  ///< usable, and keeps to the constraints
    double value = no_number;
    double violation = 0;  ///< sum over the constraints, each relative to its bound
    bool operator==(const Score&) const = default;
};

/// Returns the merit of a score; less is better. Feasible points come first, by value, then others by their violation, then
/// unusable ones.
/// K. Deb, An efficient constraint handling method for genetic algorithms, Comput. Methods Appl. Mech. Eng. 186 (2000) 311.
/// @returns a finite number, of which only the order has a meaning
double merit_of(const Score& score, bool maximise) noexcept;

/// Scores a result. @throws std::invalid_argument when a measure has no column; measure_faults() finds these before
Score score_of(const Goal& goal, std::span<const NumberColumn> columns, const PointResult& result);

/// A fault of the request of a search.
struct SearchFault {
    std::string_view subject;  ///< "maximise", "minimise" or "subject-to"
    std::string text;
};

/// Returns a fault for each measure of the goal without a column.
std::vector<SearchFault> measure_faults(const Goal& goal, std::span<const NumberColumn> columns);

}  // namespace hertzline::studies
