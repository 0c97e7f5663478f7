#pragma once
// The channels that pages show, each kept while a page wants it.

#include <map>

#include "hertzline/taps.hpp"
#include "scope/pictures/burst_spectrum.hpp"
#include "scope/pictures/channel.hpp"
#include "scope/pictures/channel_history.hpp"
#include "stream/listening/run_receiver.hpp"

namespace hertzline::scope {

struct KeptChannel {
    ChannelHistory history;
    BurstSpectra spectra;
    double wanted_at_s = 0;
};

/// For one thread.
class KeptChannels {
public:
    /// Returns a channel and notes that it is wanted now. @param now_s since 1970 [s]
    KeptChannel& want(const Channel& channel, double now_s) {
        KeptChannel& kept = channels_[channel];
        kept.wanted_at_s = now_s;
        return kept;
    }

    /// Forgets the channels that were not wanted for some time. @returns the streams of the others
    TapSet keep_wanted(double now_s) {
        constexpr double forgotten_after_s = 2;
        std::erase_if(channels_,
                      [&](const auto& kept) { return now_s - kept.second.wanted_at_s >= forgotten_after_s; });
        return streams();
    }

    /// Forgets all samples: another run has begun.
    void begin_anew() { channels_.clear(); }

    /// Returns the streams of the channels that are kept.
    TapSet streams() const noexcept {
        TapSet taps;
        for (const auto& [channel, kept] : channels_) {
            taps |= channel.tap;
        }
        return taps;
    }

    /// Takes the next frame of any stream; ignores channels that are not kept.
    void take(const stream::ReceivedFrame& frame, std::uint32_t epoch, double repetition_hz, double now_s) {
        for (auto& [channel, kept] : channels_) {
            if (channel.tap == frame.tap && channel.number <= frame.header.channels) {
                kept.history.epoch = epoch;
                kept.history.take(frame, channel.number, repetition_hz, now_s);
            }
        }
    }

private:
    std::map<Channel, KeptChannel> channels_;
};

}  // namespace hertzline::scope
