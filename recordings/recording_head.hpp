#pragma once
// The head of a recording: its check, its JSON in files, and the check of the numbers that follow it.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include "recordings/recording.hpp"

#include "core/scene/json.hpp"

namespace hertzline::recordings {

/// Returns the head's first fault, or nullopt.
std::optional<std::string> head_fault(const RecordingHead& head);

/// Columns, rate and provenance: {"sample_rate_hz", "columns": [[name, quantity, unit]...], "provenance"}.
Json describe(const RecordingHead& head);

/// Reads the head that describe() wrote, without a check of its values.
/// @throws std::runtime_error when that is no head, without the path
RecordingHead described_head(Json description, NumberType numbers);

/// The same, of a head that a recording can have.
/// @throws std::runtime_error with the fault, without the path
RecordingHead head_of(Json description, NumberType numbers);

/// A head for a file of another program: columns channel_1, channel_2... without units.
RecordingHead head_of_channels(std::size_t channels, double sample_rate_hz, NumberType numbers);

/// JSON on one line, in ASCII.
std::string text_of(const Json& json);

/// Values that were read, row-major, are all finite: no recording has other samples.
/// @param row number of the first row in the file
/// @throws std::runtime_error that names the path and the number that is not finite
void require_undamaged(const std::filesystem::path& path, std::int64_t row, std::span<const double> values,
                       std::size_t columns);

}  // namespace hertzline::recordings
