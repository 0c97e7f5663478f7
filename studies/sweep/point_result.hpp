#pragma once
// What a sweep keeps of each point: numbers in columns that are known before the first point is run, a status and a message.

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "measures/run_summary.hpp"
#include <tl/expected.hpp>

#include "core/scene/json.hpp"
#include "core/taps.hpp"

namespace hertzline::studies {

/// How a point went. In files as word_of() has it.
enum class PointStatus : std::uint32_t {
    ok,          ///< all numbers are there
    inaccurate,  ///< all numbers are there; the estimated error is above the accuracy asked for, unknown, or not of all the run
    chaotic,  ///< all numbers are there; the motion amplifies rounding errors, so that no step is good enough
    refused,  ///< the scene cannot be simulated: no numbers
    unstable,  ///< the integration failed: no numbers
    failed,    ///< the machine could not do it, as for want of memory: no numbers; --resume tries again
};
inline constexpr std::array<std::string_view, 6> point_status_words{"ok",      "inaccurate", "chaotic",
                                                                    "refused", "unstable",   "failed"};
constexpr std::string_view word_of(PointStatus status) noexcept {
    return point_status_words[static_cast<std::size_t>(status)];
}

/// A number of a summary, as a column of a sweep's table.
struct NumberColumn {
    std::string name;  ///< "peak_v_out_m_per_s", "harmonics_db_3", "p_axis.thd_r"
    std::string unit;
    bool whole = false;  ///< counts something
};

/// The column of that name; name and unit go together in all summaries.
NumberColumn number_column(const std::string& name);

/// The columns of numbers: all that the summary of `hertzline run` has that is the same each time. Those of an array end with _1, _2...;
/// those of an object in the summary begin with its name and a dot.
/// @param measured beside v_out @param modal whether there is a modal plate
std::vector<NumberColumn> number_columns(TapSet measured, bool modal);

/// Those of the columns that the names name, one by one or all of an array, in the order of the columns; estimated_error and
/// estimated_over_s are always among them. @returns the columns, or a sentence for each name that none has
tl::expected<std::vector<NumberColumn>, std::vector<std::string>> chosen_columns(
    std::vector<NumberColumn> columns, std::span<const std::string> names);

/// Puts a group's numbers where their columns are; what has no column is passed over.
class NumberPlaces {
public:
    explicit NumberPlaces(std::span<const NumberColumn> columns);
    std::size_t size() const noexcept { return size_; }
    void put(const measures::SummaryGroup& group, std::span<double> numbers) const;

private:
    void put(std::string_view name, const Json& value, std::span<double> numbers) const;

    std::vector<std::pair<std::string, std::size_t>> places_;  // sorted by name
    std::size_t size_;
};

inline constexpr double no_number = std::numeric_limits<double>::quiet_NaN();

/// A row, without what the plan knows of it.
struct PointResult {
    std::int64_t point = 0;
    PointStatus status = PointStatus::ok;
    std::string integrator;       ///< word; empty: none was chosen
    std::string scene_hash;       ///< of the resolved scene; empty: it could not be resolved
    std::string message;          ///< warnings, or why there are no numbers
    std::vector<double> numbers;  ///< no_number where there is none
    std::vector<float> waveform;  ///< row of the waveforms; NaN where there is no sample
};

}  // namespace hertzline::studies
