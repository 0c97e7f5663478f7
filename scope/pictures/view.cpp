#include "scope/pictures/view.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "scope/pictures/picture.hpp"

namespace hertzline::scope {

namespace {

constexpr double waits_for_a_trigger_s = 0.5;

struct Extremes {
    float low = std::numeric_limits<float>::infinity();
    float high = -std::numeric_limits<float>::infinity();
};

/// Takes the samples of a column. A comparison with NaN is false, so NaN changes nothing.
Extremes extremes_of(std::span<const float> values, Extremes so_far) noexcept {
    for (const float value : values) {
        so_far.low = value < so_far.low ? value : so_far.low;
        so_far.high = value > so_far.high ? value : so_far.high;
    }
    return so_far;
}

std::uint64_t not_before_the_run(std::int64_t sample) noexcept {
    return static_cast<std::uint64_t>(std::max<std::int64_t>(sample, 0));
}

}  // namespace

Envelope envelope(const SampleRing& samples, std::int64_t first, std::uint64_t count, std::size_t columns) {
    constexpr float nothing = std::numeric_limits<float>::quiet_NaN();
    Envelope result{std::vector<float>(columns, nothing), std::vector<float>(columns, nothing)};
    for (std::size_t column = 0; column < columns; ++column) {
        const auto from = first + static_cast<std::int64_t>(column * count / columns);
        const auto to = first + static_cast<std::int64_t>((column + 1) * count / columns);
        Extremes extremes;
        samples.for_each_piece(
            not_before_the_run(from), not_before_the_run(to),
            [&](std::span<const float> piece) { extremes = extremes_of(piece, extremes); });
        if (extremes.low <= extremes.high) {
            result.low[column] = extremes.low;
            result.high[column] = extremes.high;
        }
    }
    return result;
}

void View::ask(const ViewRequest& request) {
    const bool of_another = request.stream != request_.stream;
    const bool another_mode = request.mode != request_.mode || request.shot != request_.shot;
    if (of_another || (another_mode && request.mode != ViewMode::hold)) {
        held_ = nullptr;
    }
    if (another_mode || of_another) {
        single_from_.reset();
    }
    if (of_another) {
        level_ = LevelTrigger();
        shown_.reset();
        found_.reset();
        triggered_at_s_ = 0;
    }
    request_ = request;
    changed_ = true;
}

View::Window View::window(double fs, std::size_t capacity) const noexcept {
    const double longest = 0.9 * static_cast<double>(capacity);
    const double from = std::clamp(std::floor(request_.from_s * fs), -longest, 1e15);
    return {static_cast<std::int64_t>(from),
            static_cast<std::uint64_t>(std::clamp(std::round(request_.span_s * fs), 2.0, longest))};
}

std::optional<View::Trigger> View::found_trigger(const StreamHistory& history, std::uint64_t latest) {
    switch (request_.trigger) {
        case TriggerKind::burst:
            if (const auto mark = history.bursts.latest_by(latest);
                mark && mark->sample >= history.samples.begin()) {
                return Trigger{mark->sample, mark->burst, false};
            }
            return std::nullopt;
        case TriggerKind::level:
            level_.ask(
                {request_.level, request_.slope,
                 static_cast<std::uint64_t>(std::min(std::round(request_.hold_off_s * history.fs), 1e15))});
            level_.look_at(history.samples);
            if (const auto sample = level_.latest_by(latest); sample && *sample >= history.samples.begin()) {
                return Trigger{*sample, 0, false};
            }
            return std::nullopt;
        case TriggerKind::free:
            return std::nullopt;
    }
    return std::nullopt;
}

std::optional<View::Trigger> View::trigger(const StreamHistory& history, const Window& window, double now_s) {
    const std::int64_t after =
        std::max<std::int64_t>(window.from + static_cast<std::int64_t>(window.count), 0);
    const std::int64_t latest = static_cast<std::int64_t>(history.samples.end()) - after;
    if (latest < 0) {
        return std::nullopt;
    }
    const auto at = static_cast<std::uint64_t>(latest);
    const auto found = found_trigger(history, at);
    if (found != found_ || triggered_at_s_ == 0) {
        found_ = found;
        triggered_at_s_ = now_s;
    }
    if (now_s - history.received_at_s > waits_for_a_trigger_s / 2) {
        return found ? found : shown_;  // the stream stands still, and so does its picture
    }
    const bool waits = request_.trigger != TriggerKind::free &&
                       (now_s - triggered_at_s_ < waits_for_a_trigger_s || request_.mode == ViewMode::single);
    return waits ? found : std::optional(Trigger{at, 0, true});
}

bool View::is_to_be_held(const Trigger& trigger) const noexcept {
    return request_.mode == ViewMode::hold ||
           (request_.mode == ViewMode::single && single_from_ && trigger.sample >= *single_from_);
}

std::optional<std::string> View::picture(const StreamHistory& history, double now_s) {
    if (held_ == nullptr && history.samples.empty()) {
        return std::nullopt;
    }
    const StreamHistory& source = held_ != nullptr ? *held_ : history;
    const Window seen = window(source.fs, source.samples.capacity());
    if (held_ == nullptr) {
        if (request_.mode == ViewMode::single && !single_from_) {
            single_from_ = history.samples.end();
        }
        const std::optional<Trigger> now =
            request_.mode == ViewMode::hold && shown_ ? shown_ : trigger(history, seen, now_s);
        if (!now || (now == shown_ && !changed_)) {
            return std::nullopt;
        }
        if (is_to_be_held(*now)) {
            held_ = std::make_shared<const StreamHistory>(history);
        }
        shown_ = now;
    } else if (!changed_ || !shown_) {
        return std::nullopt;
    }
    changed_ = false;
    return bytes(held_ != nullptr ? *held_ : history, seen, *shown_);
}

std::string View::bytes(const StreamHistory& history, const Window& window, const Trigger& trigger) const {
    PictureHead head;
    head.flags = static_cast<std::uint16_t>((trigger.free ? PictureFlag::untriggered : 0) |
                                            (held_ != nullptr ? PictureFlag::held : 0));
    head.epoch = history.epoch;
    head.trigger = static_cast<std::int64_t>(trigger.sample);
    head.first = head.trigger + window.from;
    head.samples = window.count;
    head.burst = trigger.burst;
    head.rate_hz = history.fs;
    head.received_at_s = history.received_at_s;
    if (window.count > 2 * request_.columns) {
        const Envelope pixels = envelope(history.samples, head.first, window.count, request_.columns);
        head.columns = static_cast<std::uint32_t>(request_.columns);
        return picture_bytes(head, pixels.low, pixels.high);
    }
    head.samples = window.count + 1;  // the line reaches the right edge
    const Envelope samples = envelope(history.samples, head.first, head.samples, head.samples);
    head.columns = static_cast<std::uint32_t>(head.samples);
    head.flags = static_cast<std::uint16_t>(head.flags | PictureFlag::each_sample);
    return picture_bytes(head, samples.low);
}

}  // namespace hertzline::scope
