#include "apps/commands/listen/listen_session.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "recordings/columns.hpp"

#include "apps/console/signals.hpp"

namespace hertzline::app {

ListenSession::ListenSession(Tap tap, std::optional<double> wanted_s, RecordingRequest request, Notify notify)
    : received_(tap, notify), wanted_s_(wanted_s), request_(std::move(request)), notify_(std::move(notify)) {}

void ListenSession::take(const stream::Message& message) {
    if (const stream::ReceivedFrame* frame = received_.take(message)) {
        if (!recordings_) {
            begin();
        }
        for (const Json& change : received_.take_changes()) {
            recordings_->note_change(change);
        }
        take_samples(*frame);
    }
}

void ListenSession::begin() {
    recordings::RecordingHead head{.columns = {},
                                   .sample_rate_hz = received_.fs(),
                                   .numbers = recordings::NumberType::float32,
                                   .provenance = received_.provenance(),
                                   .full_scale = request_.full_scale};
    if (!request_.files.empty()) {
        head.columns =
            recordings::recorded_columns(received_.tap(), spheres_of(received_.tap(), received_.channels()));
    }
    recordings_.emplace(request_.files, head, recordings::RecordingPatience::of_a_second(stop_asked()),
                        notify_);
}

void ListenSession::take_samples(const stream::ReceivedFrame& frame) {
    std::size_t count = frame.header.n;
    if (wanted_s_) {
        const double wanted = std::max(1.0, std::round(*wanted_s_ * received_.fs()));
        const double left = wanted - static_cast<double>(samples_);
        if (left <= static_cast<double>(count)) {
            count = static_cast<std::size_t>(left);
            end(EndReason::heard_enough);
        }
    }
    if (recordings_->any_left()) {
        const auto end = frame.values.begin() + static_cast<std::ptrdiff_t>(count * received_.channels());
        recordings_->write(static_cast<std::int64_t>(frame.header.sample), {frame.values.begin(), end});
    }
    samples_ += count;
}

void ListenSession::save() {
    if (recordings_) {
        recordings_->commit();
        for (const std::string& text : recordings_->warnings()) {
            notify_(text);
        }
    }
}

Json ListenSession::summary() const {
    Json summary;
    summary["stream"] = row_of(received_.tap()).name;
    summary["run"] = received_.run();
    summary["fs"] = received_.fs();
    summary["channels"] = received_.channels();
    summary["first_sample"] = received_.first_sample();
    summary["simulated_s"] = simulated_s();
    summary["samples"] = samples_;
    summary.update(received_.account());
    summary["recordings"] = recordings_ ? recordings::recordings_json(*recordings_) : Json::array();
    summary["gapless"] = sound();
    summary["ended_by"] = word(end_reason());
    return summary;
}

}  // namespace hertzline::app
