#pragma once
// What the writers of all formats have in common: checks that none of them leaves out.

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "recordings/captures.hpp"
#include "recordings/recording.hpp"

#include "core/scene/json.hpp"

namespace hertzline::recordings {

/// A writer that has checked what it is given: whole rows, none that goes back, every number finite in the
/// recording's type. After an error it stays failed; what it took before is saved.
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

    /// Rows without a gap follow; called before their append(), the first time before all others.
    virtual void begin_capture(Capture) {}
    /// Takes rows, at least one, of which `first` is the first one's sample.
    virtual void append(std::int64_t first, std::span<const double> values) = 0;
    /// The provenance has one more change, which is before the next row.
    virtual void changed(const Json& /*change*/) {}
    /// Completes the file.
    virtual void finish() = 0;
    /// Saves whole rows of a file that cannot be completed, or shall not. May throw.
    virtual KeptRows rescue() = 0;
    /// Removes what was written.
    virtual void remove() noexcept = 0;

    const std::filesystem::path& path() const noexcept { return path_; }
    const RecordingHead& head() const noexcept { return head_; }
    /// The sample that follows the last one.
    std::int64_t due() const noexcept { return due_; }
    /// Taken so far, without those that append() is about to take.
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
