#include "scope/pictures/view.hpp"

#include <algorithm>
#include <cmath>

#include "scope/pictures/envelope.hpp"
#include "scope/pictures/picture.hpp"

namespace hertzline::scope {

namespace {

constexpr double waits_for_a_trigger_s = 0.5;

}  // namespace

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

std::optional<View::Trigger> View::found_trigger(const HeardSamples& heard, std::uint64_t latest) {
    switch (request_.trigger) {
        case TriggerKind::burst:
            if (const auto mark = heard.bursts.latest_by(latest);
                mark && mark->sample >= heard.history.begin()) {
                return Trigger{mark->sample, mark->burst, false};
            }
            return std::nullopt;
        case TriggerKind::level:
            level_.ask(
                {request_.level, request_.slope,
                 static_cast<std::uint64_t>(std::min(std::round(request_.hold_off_s * heard.fs), 1e15))});
            level_.look_at(heard.history);
            if (const auto sample = level_.latest_by(latest); sample && *sample >= heard.history.begin()) {
                return Trigger{*sample, 0, false};
            }
            return std::nullopt;
        case TriggerKind::free:
            return std::nullopt;
    }
    return std::nullopt;
}

std::optional<View::Trigger> View::trigger(const HeardSamples& heard, const Window& window, double now_s) {
    const std::int64_t after =
        std::max<std::int64_t>(window.from + static_cast<std::int64_t>(window.count), 0);
    const std::int64_t latest = static_cast<std::int64_t>(heard.history.end()) - after;
    if (latest < 0) {
        return std::nullopt;
    }
    const auto at = static_cast<std::uint64_t>(latest);
    const auto found = found_trigger(heard, at);
    if (found != found_ || triggered_at_s_ == 0) {
        found_ = found;
        triggered_at_s_ = now_s;
    }
    if (now_s - heard.heard_at_s > waits_for_a_trigger_s / 2) {
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

std::optional<std::string> View::picture(const HeardSamples& heard, double now_s) {
    if (held_ == nullptr && heard.history.empty()) {
        return std::nullopt;
    }
    const HeardSamples& source = held_ != nullptr ? *held_ : heard;
    const Window seen = window(source.fs, source.history.capacity());
    if (held_ == nullptr) {
        if (request_.mode == ViewMode::single && !single_from_) {
            single_from_ = heard.history.end();
        }
        const std::optional<Trigger> now =
            request_.mode == ViewMode::hold && shown_ ? shown_ : trigger(heard, seen, now_s);
        if (!now || (now == shown_ && !changed_)) {
            return std::nullopt;
        }
        if (is_to_be_held(*now)) {
            held_ = std::make_shared<const HeardSamples>(heard);
        }
        shown_ = now;
    } else if (!changed_ || !shown_) {
        return std::nullopt;
    }
    changed_ = false;
    return bytes(held_ != nullptr ? *held_ : heard, seen, *shown_);
}

std::string View::bytes(const HeardSamples& heard, const Window& window, const Trigger& trigger) const {
    PictureHead head;
    head.flags = static_cast<std::uint16_t>((trigger.free ? PictureFlag::untriggered : 0) |
                                            (held_ != nullptr ? PictureFlag::held : 0));
    head.epoch = heard.epoch;
    head.trigger = static_cast<std::int64_t>(trigger.sample);
    head.first = head.trigger + window.from;
    head.samples = window.count;
    head.burst = trigger.burst;
    head.rate_hz = heard.fs;
    head.heard_at_s = heard.heard_at_s;
    if (window.count > 2 * request_.columns) {
        const Envelope pixels = envelope(heard.history, head.first, window.count, request_.columns);
        head.columns = static_cast<std::uint32_t>(request_.columns);
        return picture_bytes(head, pixels.low, pixels.high);
    }
    head.samples = window.count + 1;  // the line goes on to the right edge
    const Envelope samples = envelope(heard.history, head.first, head.samples, head.samples);
    head.columns = static_cast<std::uint32_t>(head.samples);
    head.flags = static_cast<std::uint16_t>(head.flags | PictureFlag::each_sample);
    return picture_bytes(head, samples.low);
}

}  // namespace hertzline::scope
