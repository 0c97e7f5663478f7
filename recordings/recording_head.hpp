#pragma once
// The parts of every recording: its head, as JSON in files, its captures, and the checks of these and of the numbers.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/scene/json.hpp"
#include "recordings/recording.hpp"

namespace hertzline::recordings {

/// Returns the head's first fault, or nullopt.
std::optional<std::string> head_fault(const RecordingHead& head);

/// Returns columns, rate and provenance: {"sample_rate_hz", "columns": [[name, quantity, unit]...], "provenance"}.
Json describe(const RecordingHead& head);

/// The same without the changes of the scene: for formats that have them elsewhere, as they are known only while it is written.
Json describe_without_changes(const RecordingHead& head);

/// Reads the head that describe() wrote, and checks it. @throws std::runtime_error with the fault, without the path
RecordingHead head_of(Json description, NumberType numbers);

/// Makes a head for a file of another program: columns channel_1, channel_2... without units.
RecordingHead head_of_channels(std::size_t channels, double sample_rate_hz, NumberType numbers);

/// Gives columns of another program names where they have none, and tells those of the same name apart: v, v_2.
void name_apart(std::vector<Column>& columns);

/// Returns the fault of a file that is a table in place of a recording, by the name of its first column: "point" of a sweep, a search
/// or a field, "frequency_hz" of a spectrum.
std::optional<std::string> table_in_place_of_recording(std::string_view first_column);

/// Checks that all values that were read, row-major, are finite: no recording has other samples.
/// @param row number of the first row in the file
/// @throws std::runtime_error that names the path and the number that is not finite
void require_undamaged(const std::filesystem::path& path, std::int64_t row, std::span<const double> values,
                       std::size_t columns);

/// The begin of rows without a gap.
struct Capture {
    std::int64_t row = 0;     ///< index in the recording
    std::int64_t sample = 0;  ///< index in the run
    bool operator==(const Capture&) const = default;
};

/// Gives a reader, row after row, the next sample and the distance to the next gap.
class CaptureCursor {
public:
    CaptureCursor() = default;

    /// @throws std::runtime_error with the fault, without the path: the first row must be 0, rows must exist, and
    /// samples must be missing between captures.
    CaptureCursor(std::vector<Capture> captures, std::int64_t rows);

    std::int64_t row() const noexcept { return row_; }
    std::int64_t sample() const noexcept;
    /// Rows from here to the next gap, 0 at the end.
    std::int64_t left() const noexcept;
    /// Advances by at most left() rows.
    void advance(std::int64_t rows) noexcept;

private:
    bool follows(const Capture& now, const Capture* before) const noexcept;

    std::vector<Capture> captures_;
    std::int64_t rows_ = 0;
    std::int64_t row_ = 0;
    std::size_t current_ = 0;
};

}  // namespace hertzline::recordings
