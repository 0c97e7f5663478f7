#pragma once
// The recent past of one channel, from which pictures are made: its last samples, its bursts, and its last arrival.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "stream/listening/run_receiver.hpp"
#include "stream/wire/frame_codec.hpp"

namespace hertzline::scope {

/// A ring of samples of one channel. Samples are counted from the run's start. Samples that are missing between two frames
/// are NaN.
class SampleRing {
public:
    /// @param capacity samples that are held, at least 1
    explicit SampleRing(std::size_t capacity);

    /// Appends samples. Samples before end() are of another run: they clear the ring first.
    void append(std::uint64_t first, std::span<const float> values);

    /// Returns the first sample that is held; the last one is before end().
    std::uint64_t begin() const noexcept { return begin_; }
    std::uint64_t end() const noexcept { return end_; }
    std::size_t capacity() const noexcept { return values_.size(); }
    bool empty() const noexcept { return begin_ == end_; }

    /// Calls take(std::span<const float>) for the samples of [first, last) that are held, in their order, once or twice.
    template <class Take>
    void for_each_piece(std::uint64_t first, std::uint64_t last, Take take) const {
        first = std::max(first, begin_);
        last = std::min(last, end_);
        while (first < last) {
            const std::size_t place = place_of(first);
            const std::size_t count = std::min<std::uint64_t>(last - first, values_.size() - place);
            take(std::span<const float>(values_).subspan(place, count));
            first += count;
        }
    }

    /// Returns one sample; NaN when it is not held.
    float at(std::uint64_t sample) const noexcept;

private:
    std::size_t place_of(std::uint64_t sample) const noexcept { return sample % values_.size(); }
    void fill_gap(std::uint64_t until);
    void put(std::uint64_t first, std::span<const float> values);

    std::vector<float> values_;
    std::uint64_t begin_ = 0;
    std::uint64_t end_ = 0;
};

/// The first sample of a burst.
struct BurstMark {
    std::uint64_t burst = 0;
    std::uint64_t sample = 0;
    bool operator==(const BurstMark&) const = default;
};

/// Whether the starts of bursts up to this one are whole numbers that a double holds: numbers of a header or meta may be wrong.
/// @param repetition_hz 0: bursts do not repeat, and cannot be counted
bool countable(std::uint64_t burst, double fs, double repetition_hz) noexcept;

/// The starts of the last bursts. A header has the burst of its first sample; a burst that begins within a frame is known
/// with the next frame.
class BurstMarks {
public:
    static constexpr std::size_t most = 8192;

    /// Takes the next frame's header. @param repetition_hz of the scene, where it is known: it places bursts that begin and
    /// end within one frame
    void take(const stream::FrameHeader& header, double repetition_hz);
    void clear() noexcept { marks_.clear(); }

    /// Returns the latest burst that began at `sample` or before.
    std::optional<BurstMark> latest_by(std::uint64_t sample) const;
    /// Returns the burst after the one that began at `sample`.
    std::optional<BurstMark> next_after(std::uint64_t sample) const;
    /// Returns the latest burst.
    std::optional<BurstMark> latest() const;

private:
    void add(BurstMark mark);

    std::deque<BurstMark> marks_;
};

/// Samples of a channel that are kept for pictures: 8 MiB, 0.2 s at 10 MHz.
inline constexpr std::size_t held_samples = std::size_t{1} << 21;

/// The part of one channel that pictures are made of.
struct ChannelHistory {
    SampleRing samples{held_samples};
    BurstMarks bursts;
    double fs = 0;             ///< [Hz]; 0: no frame was received
    double repetition_hz = 0;  ///< of the bursts; 0: there is one
    std::uint32_t epoch = 0;   ///< of the scene, of the last frame
    double received_at_s = 0;  ///< arrival of the last frame [s since 1970]

    /// Takes the next frame of the channel's stream. @param number of the channel, from 1 on
    void take(const stream::ReceivedFrame& frame, std::size_t number, double bursts_hz, double now_s);
};

}  // namespace hertzline::scope
