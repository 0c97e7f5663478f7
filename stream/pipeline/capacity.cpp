#include "stream/pipeline/capacity.hpp"

#include <algorithm>

namespace hertzline::stream {

namespace {

constexpr double reserve_s = 0.05;                     // wall time that the ring's samples last,
constexpr double max_ring_bytes = 64.0 * 1024 * 1024;  // unless that is more than this;
constexpr double cached_ring_bytes = 1024.0 * 1024;    // flat out nothing is held back: it stays in cache
constexpr double min_blocks = 4;
constexpr double release_period_s = 0.5e-3;
constexpr double max_blocks = 4096;

double block_bytes(const StreamFormat& format, TapSet taps) noexcept {
    return static_cast<double>(format.frame_samples) * sizeof(double) * channels_of(taps, format.counts);
}

TapSet small_taps(const StreamFormat& format) noexcept {
    return format.taps - format.of_chain();
}

/// Not rounded to a whole number: the estimate of the memory is given in this.
double blocks_with(TapSet taps, const StreamFormat& format, Pace pace) noexcept {
    const double frame_rate = format.sample_rate_hz / static_cast<double>(format.frame_samples);
    const double by_time = pace.is_flat_out() ? max_blocks : reserve_s * pace.times() * frame_rate;
    const double by_memory =
        (pace.is_flat_out() ? cached_ring_bytes : max_ring_bytes) / std::max(1.0, block_bytes(format, taps));
    return std::clamp(std::min(by_time, by_memory), min_blocks, max_blocks);
}

}  // namespace

RingSize ring_size(const StreamFormat& format, Pace pace) noexcept {
    RingSize size{.blocks = static_cast<std::size_t>(blocks_with(small_taps(format), format, pace))};
    if (!format.of_chain().empty()) {
        size.chain_blocks = static_cast<std::size_t>(blocks_with(format.taps, format, pace));
    }
    if (!pace.is_flat_out()) {
        const auto frame_samples = static_cast<std::uint64_t>(format.frame_samples);
        size.refill =
            std::max<std::uint64_t>(1, samples_per_release(format, pace, size.blocks) / frame_samples);
    }
    return size;
}

std::uint64_t samples_per_release(const StreamFormat& format, Pace pace, std::size_t blocks) noexcept {
    const double quarter = static_cast<double>(blocks) / 4 * static_cast<double>(format.frame_samples);
    const double by_time = format.sample_rate_hz * pace.times() * release_period_s;
    return static_cast<std::uint64_t>(std::max(1.0, std::min(by_time, quarter)));
}

double ring_bytes(const StreamFormat& format, Pace pace) noexcept {
    const double small =
        blocks_with(small_taps(format), format, pace) * block_bytes(format, small_taps(format));
    return format.of_chain().empty()
               ? small
               : small + blocks_with(format.taps, format, pace) * block_bytes(format, format.taps);
}

double largest_frame_bytes(const StreamFormat& format) noexcept {
    std::size_t channels = 1;
    for (const Tap tap : format.taps) {
        channels = std::max(channels, format.channels(tap));
    }
    return static_cast<double>(format.frame_samples) * static_cast<double>(channels) * sizeof(float);
}

double usual_queue_bytes(std::optional<std::uint64_t> available) noexcept {
    constexpr double most = 1024.0 * 1024 * 1024;
    return available ? std::min(most, static_cast<double>(*available) / 8) : most;
}

}  // namespace hertzline::stream
