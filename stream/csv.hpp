#pragma once
// Samples as comma-separated text: a header of column names, then a row per sample.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/scene.hpp"

namespace hertzline {

class OutputFile;

/// The columns of a run's CSV: t_s, v_last_m_per_s, for a plate v_plate_m_per_s and v_out_m_per_s, then
/// xI_m and vI_m_per_s for the first `spheres_listed` spheres, I from 1.
std::vector<std::string> csv_columns(EndKind end, std::int64_t spheres_listed = 0);

/// Appends `number` with 17 significant digits, enough to read back the same bits; independent of the locale.
void append_csv_number(std::string& text, double number);

/// Writes a CSV to an OutputFile, which the caller opens before and commits afterwards. Memory: one row; the
/// file has the large buffer. Errors of the file pass through: std::runtime_error with path and reason, at a
/// row or at the file's commit().
class CsvWriter {
public:
    /// Writes the header. `out` must outlive the writer; `columns` names the time first.
    CsvWriter(OutputFile& out, const std::vector<std::string>& columns);

    /// A row: the time, then the values, one for each further column (else std::invalid_argument).
    void row(double t, std::span<const double> values);

private:
    OutputFile& out_;
    std::size_t values_;
    std::string line_;
};

}  // namespace hertzline
