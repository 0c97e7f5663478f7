#pragma once
// Samples as comma-separated text: a line of column names, the time t_s first, then a line for each sample. A gap
// shows in the times.
//
// Units, rate and provenance lie beside the CSV in FILE.csv-metadata.json, as the W3C recommendations for CSV on the
// Web have it ("Metadata Vocabulary for Tabular Data", 2015, and the place of that file in "Model for Tabular Data
// and Metadata on the Web", section 5.3); not beside a device or FIFO.

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "core/scene/json.hpp"
#include "recordings/recording.hpp"

namespace hertzline::recordings {

class OutputFile;

/// The first column.
inline constexpr const char* csv_time_column = "t_s";

/// Appends the shortest text of `number` that reads back the same bits; independent of the locale.
void append_csv_number(std::string& text, double number);

/// A column of a CSV.
struct CsvColumn {
    Column about;
    const char* datatype;  ///< "double", "float", "integer" or "string"
};

/// Returns the path of a CSV's metadata.
std::filesystem::path csv_metadata_path(const std::filesystem::path& csv);

/// Returns the metadata of a CSV as text. @param columns at least one; the first is the abscissa
std::string csv_metadata(const std::filesystem::path& csv, std::span<const CsvColumn> columns,
                         const Json& provenance, std::optional<double> sample_rate_hz = std::nullopt);

/// Gives a CSV that is whole, and its metadata, their names.
void commit_csv(OutputFile& csv, OutputFile& metadata, const std::filesystem::path& path);

/// A CSV, under its name once it is complete.
std::unique_ptr<RecordingWriter> open_csv_writer(const std::filesystem::path& path,
                                                 const RecordingHead& head);

/// Reads a CSV with a column of times, in the dialects of csv_dialect.hpp. Without its metadata the rate is given, or that
/// of the first times. A last line without its end is left out, with a warning: it may be cut within a number.
std::unique_ptr<RecordingReader> open_csv_reader(const std::filesystem::path& path,
                                                 const ReadOptions& options = {});

}  // namespace hertzline::recordings
