#pragma once
// What the formats have in common: the head as JSON, and checks that none of them leaves out.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "stream/recordings/captures.hpp"
#include "stream/recordings/recording.hpp"

namespace hertzline::stream {

/// A writer that has checked what it is given: whole rows, none that goes back, every number finite in the
/// recording's type. After an error it stays failed.
class CheckedWriter : public RecordingWriter {
public:
    void write(std::int64_t first, std::span<const double> values) final;
    void commit() final;

protected:
    /// Throws std::invalid_argument when the head can be no recording's.
    CheckedWriter(std::filesystem::path path, RecordingHead head);

    /// Rows without a gap follow; called before their append(), the first time before all others.
    virtual void begin_capture(Capture) {}
    /// Takes rows, at least one, of which `first` is the first one's sample.
    virtual void append(std::int64_t first, std::span<const double> values) = 0;
    /// Completes the file.
    virtual void finish() = 0;

    const std::filesystem::path& path() const noexcept { return path_; }
    bool failed() const noexcept { return !failure_.empty(); }
    const RecordingHead& head() const noexcept { return head_; }
    /// Taken so far, without those that append() is about to take.
    std::int64_t rows() const noexcept { return rows_; }

private:
    void take(std::int64_t first, std::span<const double> values);
    void require_finite(std::int64_t first, std::span<const double> values) const;

    std::filesystem::path path_;
    RecordingHead head_;
    std::string failure_;
    std::int64_t rows_ = 0;
    std::int64_t due_ = 0;  // the sample that follows
};

/// "cannot write x.npy: reason".
[[noreturn]] void cannot_write(const std::filesystem::path& path, std::string_view reason);
/// "cannot read x.npy: reason".
[[noreturn]] void cannot_read(const std::filesystem::path& path, std::string_view reason);

/// Throws when one of the values, row-major and of the file's rows from `row` on, is not finite: no recording
/// has such a sample, so that the file is damaged.
void require_undamaged(const std::filesystem::path& path, std::int64_t row, std::span<const double> values,
                       std::size_t columns);

/// Columns, rate and provenance: {"sample_rate_hz", "columns": [[name, quantity, unit]...], "provenance"}.
nlohmann::ordered_json describe(const RecordingHead& head);

/// What describe() made. Throws std::runtime_error that says what is wrong, without the path.
RecordingHead head_of(nlohmann::ordered_json description, NumberType numbers);

/// JSON on one line, in ASCII.
std::string text_of(const nlohmann::ordered_json& json);

/// JSON from outside. Throws std::runtime_error when it is none, or nested so deep that others would exhaust
/// the stack over it.
nlohmann::ordered_json json_from_outside(std::string_view text);

/// A head for a file of somebody else: columns channel_1, channel_2... without units.
RecordingHead head_of_channels(std::size_t channels, double sample_rate_hz, NumberType numbers);

}  // namespace hertzline::stream
