#pragma once
// The velocities of all spheres or the forces of all contacts over one burst, as a picture: position down, time to the right.
// Frames are reduced as they come, so that a long chain takes no more memory than its picture.

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "hertzline/taps.hpp"
#include "stream/listening/run_receiver.hpp"

namespace hertzline::scope {

/// One picture, from its first frame to its last.
class ChainCapture {
public:
    static constexpr std::size_t most_rows = 256;
    static constexpr std::size_t most_columns = 512;

    /// @param from_s of the window's left edge after the burst's start, at least 0 @param span_s of the window
    /// @param repetition_hz of the bursts; 0: the picture begins at once
    ChainCapture(double from_s, double span_s, double repetition_hz);

    /// Takes the next frame of a stream of the whole chain.
    void take(const stream::ReceivedFrame& frame, double now_s);

    /// Returns the picture's bytes, once its window is full. Each cell holds the value that is largest in size there.
    const std::optional<std::string>& picture() const noexcept { return picture_; }

private:
    void begin(const stream::FrameHeader& header);
    void add(const stream::FrameHeader& header, std::span<const float> values);

    double from_s_;
    double span_s_;
    double repetition_hz_;
    std::uint64_t burst_ = 0;
    std::uint64_t trigger_ = 0;
    std::uint64_t first_ = 0;
    std::uint64_t samples_ = 0;  // 0: not begun
    std::size_t channels_ = 0;
    std::size_t rows_ = 0;
    std::size_t columns_ = 0;
    std::vector<float> cells_;
    bool forces_ = false;
    std::optional<std::string> picture_;
};

/// The latest pictures of the streams of the whole chain. Captures are seldom, because all spheres are many samples.
class ChainPictures {
public:
    struct Picture {
        std::string bytes;
        std::uint64_t number = 0;  ///< differs between any two pictures
    };

    /// Begins a capture of a stream that a page shows, if the last one is long enough ago. @param span_s of the picture @param repetition_hz of the bursts
    void want(Tap tap, double span_s, double repetition_hz, double now_s);
    /// Returns the streams that are being captured.
    TapSet captured() const;
    /// Takes the next frame of a stream of the whole chain.
    void take(const stream::ReceivedFrame& frame, double now_s);
    /// Ends all captures: their run may be over.
    void cancel() {
        captures_.clear();
        pictured_at_s_.clear();
    }
    /// Forgets pictures, too: another run has begun.
    void begin_anew() {
        cancel();
        pictures_.clear();
    }

    /// Returns the latest picture; null: none yet.
    const Picture* latest(Tap tap) const;

private:
    std::map<Tap, ChainCapture> captures_;
    std::map<Tap, Picture> pictures_;
    std::map<Tap, double> pictured_at_s_;
    std::uint64_t count_ = 0;
};

}  // namespace hertzline::scope
