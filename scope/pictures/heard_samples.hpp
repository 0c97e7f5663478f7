#pragma once
// One stream as pictures are made of it: its last samples, its bursts, and when it was last heard.

#include <cstddef>
#include <cstdint>

#include "scope/pictures/burst_marks.hpp"
#include "scope/pictures/history.hpp"

#include "stream/listening/received_run.hpp"

namespace hertzline::scope {

/// Samples of a stream that are held for pictures: 8 MiB, 0.2 s at 10 MHz.
inline constexpr std::size_t held_samples = std::size_t{1} << 21;

struct HeardSamples {
    History history{held_samples};
    BurstMarks bursts;
    double fs = 0;             ///< [Hz]; 0: nothing was heard
    double repetition_hz = 0;  ///< of the bursts; 0: there is one
    std::uint32_t epoch = 0;   ///< of the scene, when the last frame came
    double heard_at_s = 0;     ///< when the last frame came [s since 1970]

    /// Takes the next frame of one channel.
    void take(const stream::ReceivedFrame& frame, double bursts_hz, double now_s) {
        history.append(frame.header.sample, frame.values);
        bursts.take(frame.header, bursts_hz);
        repetition_hz = bursts_hz;
        fs = frame.header.fs;
        heard_at_s = now_s;
    }
};

}  // namespace hertzline::scope
