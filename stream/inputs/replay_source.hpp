#pragma once
// A recording that is streamed again.

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "recordings/recording.hpp"
#include "stream/inputs/sample_source.hpp"

namespace hertzline::stream {

/// Sample indices are the recording's: where samples were lost they jump, here too, and a frame ends before.
/// Unlike a simulation it reads a file, in the simulating thread.
class ReplaySource : public SampleSource {
public:
    /// Columns of taps that are streamed become the streams of that name; others are passed over.
    /// In a recording of another program, without these quantities, one column is streamed as v_out and several
    /// as v_chain. Numbers in mm/s become numbers in m/s.
    /// @throws std::runtime_error when the recording holds no samples, two columns of one tap, or is damaged
    ReplaySource(std::unique_ptr<recordings::RecordingReader> reader, double sample_rate_hz,
                 std::int64_t frame_samples);

    const recordings::RecordingHead& head() const noexcept { return reader_->head(); }
    /// Returns a sentence for each column whose numbers are streamed in a unit that may not be theirs.
    const std::vector<std::string>& warnings() const noexcept { return warnings_; }

    StreamFormat format() const override { return format_; }
    bool read(Samples& samples, std::size_t count, TapSet wanted) noexcept override;
    bool skip(std::int64_t count) noexcept override;
    void interrupt() noexcept override { reader_->interrupt(); }
    std::int64_t samples_to_change() noexcept override;
    Epoch epoch() const noexcept override;
    std::int64_t next_sample() const noexcept override { return next_; }
    std::string failure() const override { return failure_; }

private:
    /// A column of the recording, as a channel of a stream.
    struct Channel {
        std::size_t column = 0;
        double in_unit = 1;  ///< a number of the column in the stream's unit is so many times as large
    };

    void find_columns();
    void add_column(std::size_t column, Tap tap);
    void count_channels();
    bool refill() noexcept;
    std::int64_t rows_left() const noexcept;
    void pass(std::int64_t rows) noexcept;
    void put_down(Samples& samples, std::int64_t count) const noexcept;

    std::unique_ptr<recordings::RecordingReader> reader_;
    StreamFormat format_;
    std::vector<Epoch> epochs_;                   // none: not known
    std::size_t epoch_ = 0;                       // of them, the present one
    std::vector<std::vector<Channel>> channels_;  // of each tap
    std::vector<std::string> warnings_;
    recordings::RecordedRows rows_;  // read and not handed on
    std::int64_t row_ = 0;           // of them, the next one
    std::int64_t next_ = 0;          // its index
    std::string failure_;
};

}  // namespace hertzline::stream
