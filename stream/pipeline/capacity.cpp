#include "stream/pipeline/capacity.hpp"

#include <algorithm>

namespace hertzline::stream {

namespace {

constexpr double reserve_s = 0.05;                     // of wall time that the ring's samples last,
constexpr double max_ring_bytes = 64.0 * 1024 * 1024;  // unless that is more than this;
constexpr double cached_ring_bytes = 1024.0 * 1024;    // flat out nothing is held back: it stays in cache
constexpr double min_slots = 4;
constexpr double max_slots = 4096;

double slot_bytes(const StreamFormat& format) noexcept {
    return static_cast<double>(format.frame_samples) * sizeof(double) *
           channels_of(format.taps, static_cast<double>(format.spheres));
}

/// Not rounded to a whole number: the estimate of the memory is given in this.
double slots_for(const StreamFormat& format, Pace pace) noexcept {
    const double frame_rate = format.sample_rate_hz / static_cast<double>(format.frame_samples);
    const double by_time = pace.is_flat_out() ? max_slots : reserve_s * pace.times() * frame_rate;
    const double by_memory = (pace.is_flat_out() ? cached_ring_bytes : max_ring_bytes) / slot_bytes(format);
    return std::clamp(std::min(by_time, by_memory), min_slots, max_slots);
}

}  // namespace

std::size_t ring_slots(const StreamFormat& format, Pace pace) noexcept {
    return static_cast<std::size_t>(slots_for(format, pace));
}

double ring_bytes(const StreamFormat& format, Pace pace) noexcept {
    return slots_for(format, pace) * slot_bytes(format);
}

PublisherOptions publisher_options(const StreamFormat& format) noexcept {
    constexpr double max_queued_bytes = 512.0 * 1024 * 1024;  // for one subscriber that does not keep up
    const double largest_frame = static_cast<double>(format.frame_samples) *
                                 static_cast<double>(std::max<std::size_t>(1, format.spheres)) *
                                 sizeof(float);
    PublisherOptions options;
    options.send_high_water_mark =
        static_cast<int>(std::clamp(max_queued_bytes / largest_frame, 16.0, 65536.0));
    return options;
}

}  // namespace hertzline::stream
