#pragma once
// The streams that pages show, each kept while a page wants it.

#include <map>

#include "hertzline/taps.hpp"
#include "scope/pictures/burst_spectrum.hpp"
#include "scope/pictures/stream_history.hpp"
#include "stream/listening/run_receiver.hpp"

namespace hertzline::scope {

struct KeptStream {
    StreamHistory history;
    BurstSpectra spectra;
    double wanted_at_s = 0;
};

/// For one thread.
class KeptStreams {
public:
    /// Returns a stream and notes that it is wanted now. @param now_s since 1970 [s]
    KeptStream& want(Tap tap, double now_s) {
        KeptStream& stream = streams_[tap];
        stream.wanted_at_s = now_s;
        return stream;
    }

    /// Forgets the streams that were not wanted for some time. @returns the kept ones
    TapSet keep_wanted(double now_s) {
        constexpr double forgotten_after_s = 2;
        std::erase_if(streams_, [&](const auto& stream) {
            return now_s - stream.second.wanted_at_s >= forgotten_after_s;
        });
        TapSet taps;
        for (const auto& [tap, stream] : streams_) {
            taps |= tap;
        }
        return taps;
    }

    /// Takes the next frame of any stream; ignores streams that are not kept.
    void take(const stream::ReceivedFrame& frame, std::uint32_t epoch, double repetition_hz, double now_s) {
        if (const auto stream = streams_.find(frame.tap); stream != streams_.end()) {
            stream->second.history.epoch = epoch;
            stream->second.history.take(frame, repetition_hz, now_s);
        }
    }

    const std::map<Tap, KeptStream>& all() const noexcept { return streams_; }

private:
    std::map<Tap, KeptStream> streams_;
};

}  // namespace hertzline::scope
