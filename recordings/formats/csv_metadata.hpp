#pragma once
// The metadata of a CSV in the file beside it: see csv.hpp.

#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include "recordings/recording.hpp"

#include "core/scene/json.hpp"

namespace hertzline::recordings {

/// A column of a CSV.
struct CsvColumn {
    Column about;
    const char* datatype;  ///< "double", "float", "integer" or "string"
};

/// Where the metadata of a CSV lies.
std::filesystem::path csv_metadata_path(const std::filesystem::path& csv);

/// The metadata of a CSV as text. @param columns at least one; the first is the abscissa
std::string csv_metadata(const std::filesystem::path& csv, std::span<const CsvColumn> columns,
                         const Json& provenance, std::optional<double> sample_rate_hz = std::nullopt);

}  // namespace hertzline::recordings
