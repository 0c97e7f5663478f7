#pragma once
// The losses of a listener. ZeroMQ drops silently at a full queue, so the frames' own numbers are the only
// account: a step of more than one in seq is a gap; as far as `dropped` grew by it the program itself discarded
// those frames, the rest was lost on the way. One check per topic, since seq counts a topic's frames.

#include <cstdint>
#include <string>

#include "stream/wire/frame_codec.hpp"

namespace hertzline::stream {

/// The relation of a frame to the frames before it.
enum class Arrival {
    joined,        ///< the first frame of all; earlier frames were never ours
    in_order,      ///< follows the frame before it
    gap,           ///< something is missing before it
    new_run,       ///< the first frame of another run; counting restarts, as when joining
    repeated,      ///< the frame that came last, again; not counted as received
    out_of_order,  ///< a frame before the one that came last; not counted as received
    inconsistent,  ///< seq goes forward, but sample goes back or leaves no room for the missing frames; not counted
                   ///< as received
};

/// Sums since the first frame, over all runs.
struct ContinuityTotals {
    std::uint64_t frames = 0;             ///< received and in order
    std::uint64_t samples = 0;            ///< in those frames
    std::uint64_t missing_samples = 0;    ///< skipped by the sample index
    std::uint64_t dropped_by_sender = 0;  ///< missing frames that the program discarded itself
    std::uint64_t lost_on_the_way = 0;    ///< the other missing frames
    std::uint64_t runs = 0;
    std::uint64_t repeated = 0;
    std::uint64_t out_of_order = 0;
    std::uint64_t inconsistent = 0;
    bool operator==(const ContinuityTotals&) const = default;
};

/// Finds missing frames of one topic.
class ContinuityCheck {
public:
    /// Takes the topic's next frame, as it arrived.
    Arrival take(const FrameHeader& frame);

    /// Takes the sender's summary: the number of frames of the topic that it discarded. Those that no frame has
    /// reported were the last ones. @returns how many these are
    std::uint64_t take_end(std::uint64_t dropped) noexcept;

    const ContinuityTotals& totals() const noexcept { return totals_; }

    /// Nothing is missing and nothing was odd.
    bool gapless() const noexcept;

    /// The totals as one line: "1000 frames, 1024000 samples, nothing missing".
    std::string text() const;

private:
    Arrival begin(const FrameHeader& frame, Arrival how);
    Arrival continue_with(const FrameHeader& frame);
    void expect_after(const FrameHeader& frame) noexcept;

    ContinuityTotals totals_;
    std::string run_;
    std::uint64_t next_seq_ = 0;
    std::uint64_t next_sample_ = 0;
    std::uint64_t dropped_ = 0;  // by the last frame
};

}  // namespace hertzline::stream
