#include "scope/pictures/burst_marks.hpp"

#include <algorithm>

#include "core/model/bursts.hpp"

namespace hertzline::scope {

namespace {

constexpr auto sample_of = [](const BurstMark& mark) { return mark.sample; };

}  // namespace

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

}  // namespace hertzline::scope
