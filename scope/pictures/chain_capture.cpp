#include "scope/pictures/chain_capture.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/model/bursts.hpp"
#include "scope/pictures/channel_history.hpp"
#include "scope/pictures/picture.hpp"

namespace hertzline::scope {

namespace {

constexpr double most_samples = 1 << 26;
constexpr double pause_s = 0.5;  // between two pictures

}  // namespace

ChainCapture::ChainCapture(double from_s, double span_s, double repetition_hz)
    : from_s_(std::max(from_s, 0.0)), span_s_(span_s), repetition_hz_(repetition_hz) {}

void ChainCapture::begin(const stream::FrameHeader& header) {
    trigger_ = header.sample;
    burst_ = header.burst;
    if (countable(header.burst, header.fs, repetition_hz_)) {
        const Bursts bursts(header.fs, repetition_hz_);
        const auto next = static_cast<std::int64_t>(header.burst) + 1;
        const std::int64_t period = bursts.first_sample(next) - bursts.first_sample(next - 1);
        trigger_ = header.sample - header.burst_sample + static_cast<std::uint64_t>(period);
        burst_ = static_cast<std::uint64_t>(next);
    }
    const double fs = header.fs;
    first_ = trigger_ + static_cast<std::uint64_t>(std::min(std::floor(from_s_ * fs), most_samples));
    samples_ = static_cast<std::uint64_t>(std::clamp(std::round(span_s_ * fs), 2.0, most_samples));
    channels_ = header.channels;
    forces_ = header.stream == row_of(Tap::f_chain).name;
    rows_ = std::min(channels_, most_rows);
    columns_ = std::min<std::uint64_t>(samples_, most_columns);
    cells_.assign(rows_ * columns_, std::numeric_limits<float>::quiet_NaN());
}

void ChainCapture::add(const stream::FrameHeader& header, std::span<const float> values) {
    const std::uint64_t from = std::max(header.sample, first_);
    const std::uint64_t to = std::min(header.sample + header.n, first_ + samples_);
    for (std::uint64_t sample = from; sample < to; ++sample) {
        const std::size_t column = (sample - first_) * columns_ / samples_;
        const auto row_of_values = values.subspan((sample - header.sample) * channels_, channels_);
        for (std::size_t channel = 0; channel < channels_; ++channel) {
            float& cell = cells_[channel * rows_ / channels_ * columns_ + column];
            if (!(std::abs(row_of_values[channel]) <= std::abs(cell))) {
                cell = row_of_values[channel];
            }
        }
    }
}

void ChainCapture::take(const stream::ReceivedFrame& frame, double now_s) {
    const stream::FrameHeader& header = frame.header;
    if (picture_) {
        return;
    }
    if (samples_ == 0 || header.channels != channels_ ||
        header.sample + header.n < trigger_ - std::min(trigger_, samples_)) {
        begin(header);
    }
    add(header, frame.values);
    if (header.sample + header.n < first_ + samples_) {
        return;
    }
    PictureHead head;
    head.kind = PictureKind::chain;
    head.flags = static_cast<std::uint16_t>(forces_ ? PictureFlag::forces : 0);
    head.columns = static_cast<std::uint32_t>(columns_);
    head.rows = static_cast<std::uint32_t>(rows_);
    head.trigger = static_cast<std::int64_t>(trigger_);
    head.first = static_cast<std::int64_t>(first_);
    head.samples = samples_;
    head.burst = burst_;
    head.rate_hz = header.fs;
    head.received_at_s = now_s;
    picture_ = picture_bytes(head, cells_);
}

void ChainPictures::want(Tap tap, double span_s, double repetition_hz, double now_s) {
    if (!captures_.contains(tap) && now_s - pictured_at_s_[tap] > pause_s) {
        captures_.emplace(tap, ChainCapture(0, span_s, repetition_hz));
    }
}

TapSet ChainPictures::captured() const {
    TapSet taps;
    for (const auto& [tap, capture] : captures_) {
        taps |= tap;
    }
    return taps;
}

void ChainPictures::take(const stream::ReceivedFrame& frame, double now_s) {
    const auto capture = captures_.find(frame.tap);
    if (capture == captures_.end()) {
        return;
    }
    capture->second.take(frame, now_s);
    if (const auto& picture = capture->second.picture()) {
        pictures_[frame.tap] = {*picture, ++count_};
        pictured_at_s_[frame.tap] = now_s;
        captures_.erase(capture);
    }
}

const ChainPictures::Picture* ChainPictures::latest(Tap tap) const {
    const auto picture = pictures_.find(tap);
    return picture == pictures_.end() ? nullptr : &picture->second;
}

}  // namespace hertzline::scope
