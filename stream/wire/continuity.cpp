#include "stream/wire/continuity.hpp"

#include <algorithm>
#include <iterator>

#include <fmt/format.h>

namespace hertzline::stream {

Arrival ContinuityCheck::take(const FrameHeader& frame) {
    if (totals_.runs == 0) {
        return begin(frame, Arrival::joined);
    }
    if (frame.run != run_) {
        return begin(frame, Arrival::new_run);
    }
    if (frame.seq + 1 == next_seq_) {
        ++totals_.repeated;
        return Arrival::repeated;
    }
    if (frame.seq < next_seq_) {
        ++totals_.out_of_order;
        return Arrival::out_of_order;
    }
    return continue_with(frame);
}

Arrival ContinuityCheck::begin(const FrameHeader& frame, Arrival how) {
    ++totals_.runs;
    run_ = frame.run;
    expect_after(frame);
    return how;
}

Arrival ContinuityCheck::continue_with(const FrameHeader& frame) {
    const std::uint64_t missing_frames = frame.seq - next_seq_;
    const std::uint64_t newly_dropped = frame.dropped > dropped_ ? frame.dropped - dropped_ : 0;
    const std::uint64_t dropped_here = std::min(missing_frames, newly_dropped);
    totals_.dropped_by_sender += dropped_here;
    totals_.lost_on_the_way += missing_frames - dropped_here;

    // Each missing frame held at least one sample. More may be missing than the frames show: without a listener (our
    // own connection was broken, say) a topic's frames are not made, and seq stands still.
    if (frame.sample < next_sample_ || frame.sample - next_sample_ < missing_frames) {
        ++totals_.inconsistent;
        next_seq_ = frame.seq + 1;
        dropped_ = frame.dropped;
        return Arrival::inconsistent;
    }
    const std::uint64_t missing_samples = frame.sample - next_sample_;
    totals_.missing_samples += missing_samples;
    expect_after(frame);
    return missing_samples == 0 ? Arrival::in_order : Arrival::gap;
}

void ContinuityCheck::expect_after(const FrameHeader& frame) noexcept {
    ++totals_.frames;
    totals_.samples += frame.n;
    next_seq_ = frame.seq + 1;
    next_sample_ = frame.sample + frame.n;
    dropped_ = frame.dropped;
}

std::uint64_t ContinuityCheck::take_end(std::uint64_t dropped) noexcept {
    const std::uint64_t last = dropped > dropped_ ? dropped - dropped_ : 0;
    totals_.dropped_by_sender += last;
    dropped_ += last;
    return last;
}

bool ContinuityCheck::gapless() const noexcept {
    return totals_.missing_samples + totals_.dropped_by_sender + totals_.lost_on_the_way + totals_.repeated +
               totals_.out_of_order + totals_.inconsistent ==
           0;
}

std::string ContinuityCheck::text() const {
    std::string line = fmt::format("{} frames, {} samples", totals_.frames, totals_.samples);
    const auto add = [&line](std::uint64_t count, const char* what) {
        if (count != 0) {
            fmt::format_to(std::back_inserter(line), ", {} {}", count, what);
        }
    };
    add(totals_.missing_samples, "samples missing");
    add(totals_.dropped_by_sender, "frames dropped by the sender");
    add(totals_.lost_on_the_way, "frames lost on the way");
    add(totals_.repeated, "frames repeated");
    add(totals_.out_of_order, "frames out of order");
    add(totals_.inconsistent, "frames inconsistent");
    add(totals_.runs > 1 ? totals_.runs : 0, "runs");
    return gapless() ? line + ", nothing missing" : line;
}

}  // namespace hertzline::stream
