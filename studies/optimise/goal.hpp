#pragma once
// What a search looks for: a measure that is to be large or small, and what others must keep to.

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "studies/sweep/point_result.hpp"
#include <tl/expected.hpp>

namespace hertzline::studies {

/// "peak_v_out_m_per_s >= 0.3"
struct Constraint {
    std::string measure;
    bool at_least = true;  ///< else at most
    double bound = 0;      ///< in the measure's unit

    /// The same for equal constraints.
    std::string text() const;
};

/// Reads "MEASURE >= NUMBER" or "MEASURE <= NUMBER". @returns the constraint, or a sentence without the option's name
tl::expected<Constraint, std::string> parse_constraint(std::string_view text);

struct Goal {
    std::string measure;
    bool maximise = true;
    std::vector<Constraint> constraints;
};

/// What a point is worth.
struct Score {
    bool usable = false;    ///< has the numbers that are looked at, and they can be trusted: not chaotic
    bool feasible = false;  ///< and keeps to the constraints
    double value = no_number;
    double violation = 0;  ///< sum over the constraints, each relative to its bound
    bool operator==(const Score&) const = default;
};

/// Less is better: feasible points by their value, then the others by how far they are from feasible, then those that cannot be used.
/// K. Deb, An efficient constraint handling method for genetic algorithms, Comput. Methods Appl. Mech. Eng. 186 (2000) 311.
/// @returns a finite number. Its order means something, its differences do not.
double merit_of(const Score& score, bool maximise) noexcept;

/// Scores the rows of a sweep.
class Judge {
public:
    /// @throws std::invalid_argument when no column has a measure's name; measure_faults() finds these before
    Judge(const Goal& goal, std::span<const NumberColumn> columns);

    Score score(const PointResult& result) const;

private:
    struct Limit {
        std::size_t column;
        Constraint constraint;
    };
    std::size_t column_;
    std::vector<Limit> limits_;
};

/// What is wrong with one of the things that a search is asked for.
struct SearchFault {
    std::string_view subject;  ///< "maximise", "minimise", "subject-to"
    std::string text;
};

/// A fault for each measure of the goal that no column has.
std::vector<SearchFault> measure_faults(const Goal& goal, std::span<const NumberColumn> columns);

}  // namespace hertzline::studies
