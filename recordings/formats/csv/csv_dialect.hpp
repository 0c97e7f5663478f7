#pragma once
// The dialects of CSV that spreadsheets of any country, numerical programs and oscilloscopes export: separators, decimal commas,
// quotes, lines before the column names, units below them.

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "recordings/formats/csv/csv_lines.hpp"
#include "recordings/recording.hpp"
#include "recordings/time_axis.hpp"

namespace hertzline::recordings {

/// The head of a CSV.
struct CsvNames {
    char separator = ',';
    std::size_t time_column = 0;  ///< 1 behind a column of row numbers, which has no name
    double time_unit_s = 1;
    bool has_times = true;        ///< false: one column, a sample in each line
    std::vector<Column> columns;  ///< those after the time
    CsvLines::Place first_row{};  ///< the end of the line before it
    bool has_rows = false;        ///< the present line is the first one
};

/// Goes to the first row of numbers, past the column names and a line of units. @param rate_is_given then a file may have a single column,
/// without times @throws std::runtime_error when no line names a column of times
CsvNames read_csv_names(CsvLines& lines, bool rate_is_given);

/// Reads the numbers of lines.
class CsvNumbers {
public:
    explicit CsvNumbers(const CsvNames& names)
        : separator_(names.separator),
          passed_over_(names.time_column),
          count_(names.columns.size() + 1),
          first_(names.has_times ? 0 : 1) {}

    /// Goes to the next line with numbers, past blank lines and comments; false at the end.
    /// @param empty takes path and number of the first blank line that was passed over
    static bool next(CsvLines& lines, std::string* empty = nullptr);
    /// Reads the present line: its time, if it has one, then one number for each column. Fails when it has others.
    void read(const CsvLines& lines, double& time, std::vector<double>& row);
    /// Reads the time alone. @param digits count its digits
    double time(const CsvLines& lines, TimeDigits& digits);

private:
    const char* number(const char* at, const char* end, double& number);
    const char* cell_number(const char* at, const char* end, double& number);
    void keep_to(char decimal);
    [[noreturn]] void refuse(const CsvLines& lines) const;

    char separator_;
    std::size_t passed_over_;
    std::size_t count_;
    std::size_t first_;    // 1: lines have no time
    char decimal_ = 0;     // the decimal separator seen; 0: none yet
    bool mixed_ = false;   // another one, too
    std::string spelled_;  // a number with a decimal point
};

}  // namespace hertzline::recordings
