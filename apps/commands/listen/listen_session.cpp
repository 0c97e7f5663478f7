#include "apps/commands/listen/listen_session.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "recordings/columns.hpp"

#include "apps/console/signals.hpp"

namespace hertzline::app {

ListenSession::ListenSession(stream::RunReceiver& run, std::optional<double> wanted_s,
                             RecordingRequest request, stream::RunReceiver::Notify notify)
    : run_(run), wanted_s_(wanted_s), request_(std::move(request)), notify_(std::move(notify)) {}

void ListenSession::begin() {
    recordings::RecordingHead head{.columns = {},
                                   .sample_rate_hz = run_.fs(),
                                   .numbers = recordings::NumberType::float32,
                                   .provenance = run_.provenance(),
                                   .full_scale = request_.full_scale};
    if (!request_.files.empty()) {
        head.columns = recordings::recorded_columns(run_.tap(), spheres_of(run_.tap(), run_.channels()));
    }
    recordings_.emplace(request_.files, head, recordings::RecordingPatience::of_a_second(stop_asked()),
                        notify_);
}

void ListenSession::take(const stream::ReceivedFrame& frame) {
    if (!recordings_) {
        begin();
    }
    for (const Json& change : run_.take_changes()) {
        recordings_->note_change(change);
    }
    std::size_t count = frame.header.n;
    if (wanted_s_) {
        const double wanted = std::max(1.0, std::round(*wanted_s_ * run_.fs()));
        const double left = wanted - static_cast<double>(samples_);
        if (left <= static_cast<double>(count)) {
            count = static_cast<std::size_t>(left);
            run_.end(stream::EndReason::long_enough);
        }
    }
    if (recordings_->any_left()) {
        const auto end = frame.values.begin() + static_cast<std::ptrdiff_t>(count * run_.channels());
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
    summary["stream"] = row_of(run_.tap()).name;
    summary["run"] = run_.run();
    summary["fs"] = run_.fs();
    summary["channels"] = run_.channels();
    summary["first_sample"] = run_.first_sample();
    summary["simulated_s"] = simulated_s();
    summary["samples"] = samples_;
    summary.update(run_.account());
    summary["recordings"] = recordings_ ? recordings::recordings_json(*recordings_) : Json::array();
    summary["gapless"] = run_.complete();
    summary["ended_by"] = word(run_.end_reason());
    return summary;
}

}  // namespace hertzline::app
