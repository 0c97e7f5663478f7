#pragma once
// A recording: samples in a file with their full description. The file's ending picks the format; every format is
// written and read through the two classes below.

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/scene/json.hpp"

namespace hertzline::recordings {

/// One number of each sample.
struct Column {
    std::string name;      ///< with its unit, as in the CSV: "v_out_m_per_s", "x1_m"
    std::string quantity;  ///< whose column it is: "v_out"; "v_chain" for those of the spheres
    std::string unit;      ///< "m/s"
    bool operator==(const Column&) const = default;
};

/// The type of numbers in formats that have both. SigMF and WAV hold float32.
enum class NumberType { float32, float64 };

/// The description of a recording's samples.
struct RecordingHead {
    std::vector<Column> columns;  ///< at least one; the time is not among them
    double sample_rate_hz = 0;    ///< of a file that was read 0: it does not tell
    NumberType numbers = NumberType::float64;
    Json
        provenance;  ///< an object (measures/provenance); with "changes" where the scene may change on the way
    /// The sample that a WAV holds as 1, in each column's unit. Other formats hold samples unscaled.
    double full_scale = 1;
};

/// The time at which a recording takes its name. Only SigMF can do so early: other formats are whole at their end.
enum class Appearance {
    early,          ///< with its first row, so that it survives the sudden end of the program
    when_complete,  ///< an older file stays until then
};

/// Rows that follow one another without a gap.
struct RecordedRows {
    std::int64_t first = 0;      ///< index of the first sample since the run's start
    std::vector<double> values;  ///< row-major, [sample][column]
    /// In place of rows: a change of the scene with the next row (stream/control/scene_change.hpp). null: rows.
    Json change = nullptr;
};

/// The remains of a recording: the number of rows and their file (empty: none). Without a number the file may hold
/// any number of rows, because the system reported an error when it was closed.
struct KeptRows {
    std::int64_t rows = 0;
    std::filesystem::path file;
};

/// A recording that is being written. Errors are std::runtime_error that names the path and the reason; after one the
/// recording is at its end, and kept() has the saved rows.
class RecordingWriter {
public:
    /// Without commit() or keep() no file is left, except in formats that take their name early.
    virtual ~RecordingWriter() = default;
    /// Appends rows, row-major [sample][column], the first of which is sample `first` of the run. A `first`
    /// beyond the sample that was due marks a gap; it never goes back.
    virtual void write(std::int64_t first, std::span<const double> values) = 0;
    /// The scene changes with the row that follows: becomes the last of "changes" in the provenance.
    virtual void note_change(const Json& change) = 0;
    /// Completes the recording.
    virtual void commit() = 0;
    /// Ends it before it is complete: the rows so far stay, under another name where the format takes its name only
    /// when complete. Does not throw, and does nothing after commit() or an error.
    virtual void keep() noexcept = 0;
    /// Ends it and removes the file.
    virtual void discard() noexcept = 0;
    /// Returns the rows and the file that commit(), keep() or an error left.
    virtual const KeptRows& kept() const noexcept = 0;
    /// Returns a sentence about samples that other programs would misread; empty: none. Known at its end.
    virtual std::string warning() const { return {}; }
};

/// Options of a reader.
struct ReadOptions {
    /// The sample rate where the file does not tell its own.
    std::optional<double> sample_rate_hz;
    /// Takes sentences about samples that are left out, or that may not be those of the recording; empty: warnings are dropped.
    std::function<void(const std::string&)> warn;
    /// true: opening a pipe ends soon, and so does read(), without the rest of the rows; null: never. It outlives the reader.
    const std::atomic<bool>* stop = nullptr;

    void tell(const std::string& warning) const {
        if (warn) {
            warn(warning);
        }
    }
};

/// A recording that is being read. Its contents come from outside and are not trusted.
class RecordingReader {
public:
    virtual ~RecordingReader() = default;
    virtual const RecordingHead& head() const noexcept = 0;
    /// Replaces `rows` by the next ones, at most `most`; false at the end. @throws
    /// std::runtime_error that names the path and the place when the file turns out to be damaged.
    virtual bool read(RecordedRows& rows, std::size_t most) = 0;
    /// Makes read() return soon, with false; from another thread. For files whose writer may pause.
    virtual void interrupt() noexcept {}
};

}  // namespace hertzline::recordings
