#include "scope/pictures/channel_history.hpp"

#include <limits>

#include "core/model/bursts.hpp"

namespace hertzline::scope {

namespace {

constexpr auto sample_of = [](const BurstMark& mark) { return mark.sample; };

}  // namespace

SampleRing::SampleRing(std::size_t capacity) : values_(std::max<std::size_t>(capacity, 1)) {}

void SampleRing::append(std::uint64_t first, std::span<const float> values) {
    const bool beyond = first > end_ && first - end_ >= values_.size();
    if (empty() || first < end_ || beyond) {
        begin_ = end_ = first;
    }
    fill_gap(first);
    if (values.size() > values_.size()) {
        const std::size_t passed_over = values.size() - values_.size();
        values = values.subspan(passed_over);
        begin_ = end_ = first + passed_over;
    }
    put(end_, values);
}

void SampleRing::fill_gap(std::uint64_t until) {
    for (; end_ < until; ++end_) {
        values_[place_of(end_)] = std::numeric_limits<float>::quiet_NaN();
    }
    begin_ = std::max(begin_, end_ - std::min<std::uint64_t>(end_, values_.size()));
}

void SampleRing::put(std::uint64_t first, std::span<const float> values) {
    const std::size_t place = place_of(first);
    const std::size_t until_the_end = std::min(values.size(), values_.size() - place);
    std::ranges::copy(values.first(until_the_end), values_.begin() + static_cast<std::ptrdiff_t>(place));
    std::ranges::copy(values.subspan(until_the_end), values_.begin());
    end_ = first + values.size();
    begin_ = std::max(begin_, end_ - std::min<std::uint64_t>(end_, values_.size()));
}

float SampleRing::at(std::uint64_t sample) const noexcept {
    const bool held = sample >= begin_ && sample < end_;
    return held ? values_[place_of(sample)] : std::numeric_limits<float>::quiet_NaN();
}

bool countable(std::uint64_t burst, double fs, double repetition_hz) noexcept {
    constexpr double whole = 9e15;
    const double last = static_cast<double>(burst) + 2;
    return repetition_hz > 0 && last < whole && last / repetition_hz * fs < whole;
}

void BurstMarks::take(const stream::FrameHeader& header, double repetition_hz) {
    const BurstMark now{header.burst, header.sample - std::min(header.burst_sample, header.sample)};
    if (marks_.empty()) {
        add(now);
        return;
    }
    const BurstMark last = marks_.back();
    if (now.burst < last.burst || now.sample < last.sample) {
        clear();  // another run
    } else if (now.burst > last.burst + 1 && now.burst - last.burst <= most &&
               countable(now.burst, header.fs, repetition_hz)) {
        const Bursts bursts(header.fs, repetition_hz);
        const auto start = [&](std::uint64_t burst) {
            return static_cast<std::uint64_t>(bursts.first_sample(static_cast<std::int64_t>(burst)));
        };
        const bool placed = start(last.burst) == last.sample && start(now.burst) == now.sample;
        for (std::uint64_t burst = last.burst + 1; placed && burst < now.burst; ++burst) {
            add({burst, start(burst)});
        }
    }
    if (marks_.empty() || marks_.back() != now) {
        add(now);
    }
}

void BurstMarks::add(BurstMark mark) {
    marks_.push_back(mark);
    if (marks_.size() > most) {
        marks_.pop_front();
    }
}

std::optional<BurstMark> BurstMarks::latest_by(std::uint64_t sample) const {
    const auto after = std::ranges::upper_bound(marks_, sample, {}, sample_of);
    return after == marks_.begin() ? std::nullopt : std::optional(*std::prev(after));
}

std::optional<BurstMark> BurstMarks::next_after(std::uint64_t sample) const {
    const auto after = std::ranges::upper_bound(marks_, sample, {}, sample_of);
    return after == marks_.end() ? std::nullopt : std::optional(*after);
}

std::optional<BurstMark> BurstMarks::latest() const {
    return marks_.empty() ? std::nullopt : std::optional(marks_.back());
}

void ChannelHistory::take(const stream::ReceivedFrame& frame, std::size_t number, double bursts_hz,
                          double now_s) {
    const std::size_t channels = frame.header.channels;
    std::vector<float> values(frame.values.size() / channels);
    for (std::size_t i = 0; i < values.size(); ++i) {
        values[i] = frame.values[i * channels + number - 1];
    }
    samples.append(frame.header.sample, values);
    bursts.take(frame.header, bursts_hz);
    repetition_hz = bursts_hz;
    fs = frame.header.fs;
    received_at_s = now_s;
}

}  // namespace hertzline::scope
