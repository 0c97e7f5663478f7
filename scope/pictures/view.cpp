#include "scope/pictures/view.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include <Eigen/Core>

#include "scope/pictures/picture.hpp"

namespace hertzline::scope {

namespace {

constexpr double waits_for_a_trigger_s = 0.5;

struct Extremes {
    float low = std::numeric_limits<float>::infinity();
    float high = -std::numeric_limits<float>::infinity();
};

/// Takes samples of a column, at least one. NaN changes nothing.
Extremes extremes_of(std::span<const float> values, Extremes so_far) noexcept {
    const Eigen::Map<const Eigen::ArrayXf> array(values.data(), static_cast<Eigen::Index>(values.size()));
    const float low = array.minCoeff<Eigen::PropagateNumbers>();
    const float high = array.maxCoeff<Eigen::PropagateNumbers>();
    return {low < so_far.low ? low : so_far.low, high > so_far.high ? high : so_far.high};
}

/// Returns the end of the samples that all of them have: a block's frames come one after another. Those without a frame lately are left out.
std::uint64_t common_end(const ChannelHistory& history, std::span<const ChannelHistory* const> beside) {
    std::uint64_t end = history.samples.end();
    for (const ChannelHistory* other : beside) {
        if (history.received_at_s - other->received_at_s < waits_for_a_trigger_s) {
            end = std::min(end, other->samples.end());
        }
    }
    return end;
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
    const bool of_another = request.channel != request_.channel;
    const bool another_mode = request.mode != request_.mode || request.shot != request_.shot;
    if (of_another || (another_mode && request.mode != ViewMode::hold)) {
        held_.clear();
    }
    std::erase_if(held_, [&](const auto& held) {
        return held.first != request.channel &&
               std::ranges::find(request.beside, held.first) == request.beside.end();
    });
    if (another_mode) {
        single_from_.reset();
    }
    if (of_another) {
        begin_anew();
    }
    request_ = request;
    changed_ = true;
}

void View::begin_anew() {
    level_ = LevelTrigger();
    found_.reset();
    single_from_.reset();
    triggered_at_s_ = 0;
    if (!is_held()) {
        shown_.reset();
    }
}

View::Window View::window(double fs, std::size_t capacity) const noexcept {
    const double longest = 0.9 * static_cast<double>(capacity);
    const double from = std::clamp(std::floor(request_.from_s * fs), -longest, 1e15);
    return {static_cast<std::int64_t>(from),
            static_cast<std::uint64_t>(std::clamp(std::round(request_.span_s * fs), 2.0, longest))};
}

std::optional<View::Trigger> View::found_trigger(const ChannelHistory& history, std::uint64_t latest) {
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

std::optional<View::Trigger> View::trigger(const ChannelHistory& history, std::uint64_t end,
                                           const Window& window, double now_s) {
    const std::int64_t after =
        std::max<std::int64_t>(window.from + static_cast<std::int64_t>(window.count), 0);
    const std::int64_t latest = static_cast<std::int64_t>(end) - after;
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

std::optional<std::string> View::picture(const ChannelHistory& history,
                                         std::span<const ChannelHistory* const> beside, double now_s) {
    if (!is_held() && history.samples.empty()) {
        return std::nullopt;
    }
    const ChannelHistory& source = is_held() ? held_.at(request_.channel) : history;
    const Window seen = window(source.fs, source.samples.capacity());
    if (!is_held()) {
        if (request_.mode == ViewMode::single && !single_from_) {
            single_from_ = history.samples.end();
        }
        const std::optional<Trigger> now = request_.mode == ViewMode::hold && shown_
                                               ? shown_
                                               : trigger(history, common_end(history, beside), seen, now_s);
        if (!now || (now == shown_ && !changed_)) {
            return std::nullopt;
        }
        if (is_to_be_held(*now)) {
            held_.emplace(request_.channel, history);
        }
        shown_ = now;
    } else if (!changed_ || !shown_) {
        return std::nullopt;
    }
    changed_ = false;
    std::vector<const ChannelHistory*> histories{&history};
    histories.insert(histories.end(), beside.begin(), beside.end());
    if (is_held()) {
        histories.front() = &held_.at(request_.channel);
        for (std::size_t i = 0; i < beside.size(); ++i) {
            histories[i + 1] = &held_.try_emplace(request_.beside[i], *beside[i]).first->second;
        }
    }
    return bytes(histories, seen, *shown_);
}

std::string View::bytes(std::span<const ChannelHistory* const> histories, const Window& window,
                        const Trigger& trigger) const {
    const ChannelHistory& history = *histories.front();
    PictureHead head;
    head.flags = static_cast<std::uint16_t>((trigger.free ? PictureFlag::untriggered : 0) |
                                            (is_held() ? PictureFlag::held : 0));
    head.rows = static_cast<std::uint32_t>(histories.size());
    head.epoch = history.epoch;
    head.trigger = static_cast<std::int64_t>(trigger.sample);
    head.first = head.trigger + window.from;
    head.samples = window.count;
    head.burst = trigger.burst;
    head.rate_hz = history.fs;
    head.received_at_s = history.received_at_s;
    head.columns = static_cast<std::uint32_t>(request_.columns);
    const bool each_sample = window.count <= 2 * request_.columns;
    if (each_sample) {
        head.samples = window.count + 1;  // the line reaches the right edge
        head.columns = static_cast<std::uint32_t>(head.samples);
        head.flags = static_cast<std::uint16_t>(head.flags | PictureFlag::each_sample);
    }
    Envelope rows;
    for (const ChannelHistory* each : histories) {
        const Envelope row = envelope(each->samples, head.first, head.samples, head.columns);
        rows.low.insert(rows.low.end(), row.low.begin(), row.low.end());
        rows.high.insert(rows.high.end(), row.high.begin(), row.high.end());
    }
    return each_sample ? picture_bytes(head, rows.low) : picture_bytes(head, rows.low, rows.high);
}

}  // namespace hertzline::scope
