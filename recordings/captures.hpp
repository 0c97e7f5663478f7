#pragma once
// The stretches of a recording between its gaps, for formats that list them.

#include <cstddef>
#include <cstdint>
#include <vector>

namespace hertzline::recordings {

/// Where rows without a gap begin.
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
