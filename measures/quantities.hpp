#pragma once
// The quantities of a run: one table, from which summaries, columns of sweeps, measures of searches and docs/measures.md follow.

#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <tl/expected.hpp>

#include "core/scene/json.hpp"
#include "hertzline/spectrum.hpp"
#include "hertzline/taps.hpp"
#include "measures/run.hpp"

namespace hertzline::measures {

/// Quantities that stand together in a summary.
enum class Group : unsigned char { result, spectrum, contacts, trust, run };

/// The kind of a quantity's value. Each but text is a column of a sweep's table, or one for each harmonic or for each of the first points.
enum class Kind : unsigned char { number, count, text, harmonics, points };

/// The place of a quantity among the columns of a sweep's table.
enum class Columns : unsigned char {
    none,   ///< it differs from run to run, or is no number
    first,  ///< before all others, in every table
    among,  ///< in the order of the quantities
    modal,  ///< after these, where there is a modal plate
    last,
};

/// A quantity of a run.
struct Quantity {
    Group group;
    std::string_view name;  ///< "{}" stands for the tap's column
    std::string_view unit;  ///< "": a ratio, a count or a word; "tap": the tap's
    Kind kind;
    Columns columns;
    std::string_view definition;  ///< Markdown, as docs/measures.md has it
    /// Its value of a run, of a measured tap or of a tap's spectrum; null where the run does not determine it.
    std::variant<Json (*)(const Run&), Json (*)(const TapRecord&), Json (*)(const SpectrumSummary&)> value;
    bool (*exists)(const Run&) = nullptr;  ///< null: in every run
};

/// All quantities, in the order of a summary.
std::span<const Quantity> quantities() noexcept;

/// Lines of a summary that belong together.
struct SummaryGroup {
    std::string heading;  ///< above the lines, as text
    Json values;          ///< a flat object
    std::string member;  ///< in JSON the values stand in an object of this name; empty: in the summary itself
};

/// The quantities of a run, group by group. @param run measured
std::vector<SummaryGroup> summary_of(const Run& run);

/// The groups as one object.
Json summary_json(std::span<const SummaryGroup> groups);

/// A spectrum's quantities as a flat object; null where a number is absent.
Json spectrum_json(const SpectrumSummary& spectrum);

/// A number of a run, as a column of a table.
struct NumberColumn {
    std::string name;  ///< "peak_v_out_m_per_s", "harmonics_db_3", "p_axis.thd_r"
    std::string unit;
    bool whole = false;  ///< it counts something
    const Quantity* quantity = nullptr;
    Tap tap = Tap::v_out;     ///< the tap of a quantity that belongs to one
    std::size_t element = 0;  ///< the index in a quantity with a number for each harmonic
};

/// The columns of a table of runs: all numbers that are the same each time. Those of an array end with _1, _2...; those of another
/// output than v_out begin with its name and a dot.
/// @param measured beside v_out @param modal whether there is a modal plate
std::vector<NumberColumn> number_columns(TapSet measured, bool modal);

/// Returns the column of that name among all possible ones, or a fault.
tl::expected<NumberColumn, std::string> find_column(std::string_view name);

/// The columns that the names name, one by one or all of an array, in the order of the columns; estimated_error and estimated_over_s
/// are always among them. @returns the columns, or a sentence for each name that none has
tl::expected<std::vector<NumberColumn>, std::vector<std::string>> chosen_columns(
    std::vector<NumberColumn> columns, std::span<const std::string> names);

inline constexpr double no_number = std::numeric_limits<double>::quiet_NaN();

/// The run's numbers in those columns; no_number where the run does not determine it.
std::vector<double> numbers_of(const Run& run, std::span<const NumberColumn> columns);

}  // namespace hertzline::measures
