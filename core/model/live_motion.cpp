#include "core/model/live_motion.hpp"

#include <algorithm>
#include <cmath>

#include "core/model/drive.hpp"

namespace hertzline {

LiveMotion::LiveMotion(const Drive& drive, double span_s)
    : scale_(drive.scale.value_or(1)),
      velocity_(recorded_quantity(drive) == DriveQuantity::velocity),
      reconstruction_(*drive.sample_rate_hz, lowpass_hz(drive), recorded_quantity(drive)) {
    const double samples = std::ceil(span_s * *drive.sample_rate_hz);
    const std::size_t most = reconstruction_.most_pieces(portion);
    ring_.resize(2 * most + reconstruction_.most_pieces(static_cast<std::size_t>(samples)));
    found_.reserve(most);
    samples_.reserve(portion);
}

bool LiveMotion::has_room() const noexcept {
    const std::uint64_t held =
        written_.load(std::memory_order_relaxed) - released_.load(std::memory_order_acquire);
    return ring_.size() - held >= reconstruction_.most_pieces(portion);
}

void LiveMotion::append(std::span<const float> samples) {
    samples_.clear();
    for (const float sample : samples) {
        const double value = scale_ * static_cast<double>(sample);
        if (reconstruction_.samples() == 0 && samples_.empty() && !velocity_) {
            first_ = value;  // displacements are counted from the first one
        }
        samples_.push_back(value - first_);
    }
    found_.clear();
    reconstruction_.append(samples_, found_);
    std::uint64_t written = written_.load(std::memory_order_relaxed);
    for (const Polynomial& piece : found_) {
        ring_[written++ % ring_.size()] = piece;
    }
    if (!found_.empty()) {
        written_.store(written, std::memory_order_release);
        known_until_s_.store(found_.back().end_s, std::memory_order_release);
    }
}

const Polynomial& LiveMotion::at(double time_s) const noexcept {
    std::uint64_t first = released_.load(std::memory_order_relaxed);
    const std::uint64_t end = written_.load(std::memory_order_acquire);
    std::uint64_t last = end;
    while (first < last) {
        const std::uint64_t middle = first + (last - first) / 2;
        if (piece(middle).end_s > time_s) {
            last = middle;
        } else {
            first = middle + 1;
        }
    }
    if (first == end) {
        overtaken_.store(true, std::memory_order_relaxed);
        static constexpr Polynomial none{};
        return end > 0 ? piece(end - 1) : none;
    }
    return piece(first);
}

void LiveMotion::release(double time_s) noexcept {
    std::uint64_t first = released_.load(std::memory_order_relaxed);
    const std::uint64_t end = written_.load(std::memory_order_acquire);
    while (first < end && piece(first).end_s <= time_s) {
        ++first;
    }
    released_.store(first, std::memory_order_release);
}

}  // namespace hertzline
