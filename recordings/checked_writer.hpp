#pragma once
// The common base of all formats' writers, with the checks that each needs.

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "core/scene/json.hpp"
#include "recordings/recording.hpp"
#include "recordings/recording_head.hpp"

namespace hertzline::recordings {

/// A writer that checks its rows: whole, in order, every number finite in the recording's type. After an error it
/// stays failed; earlier rows are saved.
class CheckedWriter : public RecordingWriter {
public:
    void write(std::int64_t first, std::span<const double> values) final;
    void note_change(const Json& change) final;
    void commit() final;
    void keep() noexcept final;
    void discard() noexcept final;
    const KeptRows& kept() const noexcept final { return kept_; }

protected:
    /// @throws std::invalid_argument when a recording cannot have that head
    CheckedWriter(std::filesystem::path path, RecordingHead head);

    /// Begins a stretch of rows without a gap; called before their append(), first of all functions.
    virtual void begin_capture(Capture) {}
    /// Takes rows, at least one, of which `first` is the first one's sample.
    virtual void append(std::int64_t first, std::span<const double> values) = 0;
    /// Takes one more change of the provenance, which applies with the next row.
    virtual void changed(const Json& /*change*/) {}
    /// Completes the file.
    virtual void finish() = 0;
    /// Saves whole rows of a file that cannot be completed, or shall not. May throw.
    virtual KeptRows rescue() = 0;
    /// Removes the file.
    virtual void remove() noexcept = 0;

    const std::filesystem::path& path() const noexcept { return path_; }
    const RecordingHead& head() const noexcept { return head_; }
    /// The sample that follows the last one.
    std::int64_t due() const noexcept { return due_; }
    /// Rows taken so far, without those of the current append().
    std::int64_t rows() const noexcept { return rows_; }

private:
    void complete();
    void complete_or_save() noexcept;
    void save() noexcept;
    void take(std::int64_t first, std::span<const double> values);
    void require_finite(std::int64_t first, std::span<const double> values) const;

    std::filesystem::path path_;
    RecordingHead head_;
    std::string failure_;
    bool over_ = false;
    KeptRows kept_;
    std::int64_t rows_ = 0;
    std::int64_t due_ = 0;  // the sample that follows
};

}  // namespace hertzline::recordings
