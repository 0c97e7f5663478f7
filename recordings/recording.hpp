#pragma once
// A recording: samples in a file, with all that is needed to know what they are. The file's ending picks the
// format; every format is written and read through the two classes below.

#include <cstddef>
#include <cstdint>
#include <filesystem>
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

/// How numbers are kept by formats that can do both. The others (SigMF, WAV) hold float32.
enum class NumberType { float32, float64 };

/// What a recording says about its samples.
struct RecordingHead {
    std::vector<Column> columns;  ///< at least one; the time is not among them
    double sample_rate_hz = 0;
    NumberType numbers = NumberType::float64;
    Json provenance;  ///< where it comes from: an object (stream/provenance)
    /// Of WAV: what is 1 in the file, in each column's unit. Other formats hold samples as they are.
    double full_scale = 1;
};

/// When a recording takes its name. Only SigMF can early: the others are whole at their end only.
enum class Appearance {
    early,          ///< with its first row, so that it survives the sudden end of the program
    when_complete,  ///< what was there before stays until then
};

/// Rows that follow one another without a gap.
struct RecordedRows {
    std::int64_t first = 0;      ///< index of the first sample since the run's start
    std::vector<double> values;  ///< row-major, [sample][column]
    /// In place of rows: the scene changes with the row that follows, sources/control/scene_change.hpp says how. null: rows.
    Json change = nullptr;
};

/// What a recording has left: so many rows, and the file that they are in (empty: none). Without rows: nobody knows how
/// many are in that file, because the system reported an error when it was closed.
struct KeptRows {
    std::int64_t rows = 0;
    std::filesystem::path file;
};

/// A recording that is being written. Errors are std::runtime_error that names the path and the reason; after
/// one the recording is at its end, and kept() tells what was saved of it.
class RecordingWriter {
public:
    /// Without commit() or keep() nothing is left, except of formats that have their name from early on.
    virtual ~RecordingWriter() = default;
    /// Appends rows, row-major [sample][column], the first of which is sample `first` of the run. A `first`
    /// beyond the sample that was due marks a gap; it never goes back.
    virtual void write(std::int64_t first, std::span<const double> values) = 0;
    /// The scene changes with the row that follows: becomes the last of "changes" in the provenance.
    virtual void note_change(const Json& change) = 0;
    /// Completes the recording.
    virtual void commit() = 0;
    /// Ends it before it is complete: what was taken stays, under another name where the format has its own
    /// only when complete. Does not throw, and does nothing after commit() or an error.
    virtual void keep() noexcept = 0;
    /// Ends it and removes what was written.
    virtual void discard() noexcept = 0;
    /// What commit(), keep() or an error has left.
    virtual const KeptRows& kept() const noexcept = 0;
    /// What other programs may make of it that is not so, in a sentence; empty: nothing. Known at its end.
    virtual std::string warning() const { return {}; }
};

/// A recording that is being read. What it holds comes from outside and is not trusted.
class RecordingReader {
public:
    virtual ~RecordingReader() = default;
    virtual const RecordingHead& head() const noexcept = 0;
    /// The next rows, at most `most`, in place of what `rows` held; false at the end. @throws
    /// std::runtime_error that names the path and the place when the file turns out to be damaged.
    virtual bool read(RecordedRows& rows, std::size_t most) = 0;
    /// Makes read() return soon, with false; from another thread. For files that somebody else may keep waiting.
    virtual void interrupt() noexcept {}
};

}  // namespace hertzline::recordings
