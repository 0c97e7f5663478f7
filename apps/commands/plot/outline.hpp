#pragma once
// The samples of a recording reduced, while they are read, to what a picture shows of them.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace hertzline::app {

/// Smallest and largest sample of each stretch of a recording, and the samples of its spectrum. All stretches are as long, and as
/// short as their number allows: a few thousand, however long the recording is.
class Outline {
public:
    static constexpr std::size_t max_stretches = 1 << 13;
    static constexpr std::size_t max_spectrum_rows = 1 << 20;

    /// @param columns those that are drawn, of rows with `of` numbers
    Outline(std::vector<std::size_t> columns, std::size_t of);

    /// Takes rows as RecordingWriter::write() does.
    void take(std::int64_t first, std::span<const double> rows);

    bool empty() const noexcept { return end_ == 0; }
    std::size_t columns() const noexcept { return columns_.size(); }
    std::int64_t first() const noexcept { return first_; }  ///< sample
    std::int64_t end() const noexcept { return end_; }      ///< the sample after the last one
    std::int64_t width() const noexcept {
        return width_;
    }  ///< of a stretch [samples]; 1: each sample is there

    /// Smallest and largest samples of a column's stretches; NaN where there is none.
    const std::vector<double>& low(std::size_t column) const noexcept { return low_[column]; }
    const std::vector<double>& high(std::size_t column) const noexcept { return high_[column]; }

    /// Samples without a gap, row by row: the first ones of the longest part, at most max_spectrum_rows.
    struct Part {
        std::int64_t first = 0;
        std::vector<double> rows;
    };
    const Part& longest() const noexcept {
        return part_.rows.size() > longest_.rows.size() ? part_ : longest_;
    }

private:
    void widen();
    void take_stretch(std::size_t stretch, std::span<const double> rows);
    void take_part(std::int64_t first, std::span<const double> rows);

    std::vector<std::size_t> columns_;
    std::size_t of_;
    std::int64_t first_ = 0;
    std::int64_t end_ = 0;
    std::int64_t width_ = 1;
    std::vector<std::vector<double>> low_;  // [column][stretch]
    std::vector<std::vector<double>> high_;
    Part part_;  // the present one
    Part longest_;
};

}  // namespace hertzline::app
