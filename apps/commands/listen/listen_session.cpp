#include "apps/commands/listen/listen_session.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "apps/commands/listen/listen_words.hpp"
#include "apps/console/signals.hpp"
#include "core/scene/scene.hpp"
#include "core/scene/text.hpp"
#include "stream/files/json_from_outside.hpp"
#include "stream/float32.hpp"
#include "stream/provenance.hpp"
#include "stream/recordings/columns.hpp"
#include "stream/wire/frame_codec.hpp"

namespace hertzline::app {

namespace {

constexpr std::size_t largest_json = 1 << 20;  // of meta and end; a scene has at most 64 KiB
constexpr int most_notices = 3;                // of a kind; what goes wrong often is only counted

/// An object, or null when the text is none.
Json parsed_object(std::string_view text) {
    if (text.size() > largest_json) {
        return nullptr;
    }
    try {
        Json json = stream::json_from_outside(text);
        return json.is_object() ? json : Json(nullptr);
    } catch (const std::runtime_error&) {
        return nullptr;
    }
}

std::string text_in(const Json& object, const char* key) {
    const auto found = object.is_object() ? object.find(key) : object.end();
    return object.is_object() && found != object.end() && found->is_string() ? found->get<std::string>() : "";
}

/// A whole number above 0; 0 when there is none.
std::uint64_t count_in(const Json& object, const char* key) {
    const auto found = object.find(key);
    const bool whole = found != object.end() && found->is_number_integer();
    return whole ? static_cast<std::uint64_t>(std::max(std::int64_t{0}, found->get<std::int64_t>())) : 0;
}

}  // namespace

ListenSession::ListenSession(Tap tap, std::optional<double> wanted_s, RecordingRequest request, Notify notify)
    : tap_(tap), wanted_s_(wanted_s), request_(std::move(request)), notify_(std::move(notify)) {}

void ListenSession::take(const stream::Message& message) {
    if (message.topic() == topic()) {
        take_frame(message);
    } else if (message.topic() == stream::meta_topic) {
        take_meta(message);
    } else if (message.topic() == stream::end_topic) {
        take_end(message);
    }
}

void ListenSession::note_malformed(const std::string& reason) {
    if (++malformed_ == 1) {  // a peer that sends nonsense sends a lot of it
        notify_("malformed message: " + reason);
    }
}

void ListenSession::note_arrival(stream::Arrival arrival, const std::string& text) {
    if (int& told = notices_[arrival]; !text.empty() && ++told <= most_notices) {
        notify_(text + (told == most_notices ? " (more of these are only counted)" : ""));
    }
}

void ListenSession::note_refusal(const stream::Refusal& refusal) {
    if (refusal.reason != refusal_) {  // ZeroMQ tries several times a second
        notify_(refusal.reason);
        refusal_ = refusal.reason;
    }
    if (refusal.final) {
        end(EndReason::refused);
    }
}

void ListenSession::take_meta(const stream::Message& message) {
    if (heard_samples() || message.parts() != 1) {
        return;
    }
    const Json meta = parsed_object(message.text(0));
    if (!meta.is_object() || !meta.contains("streams") || !meta["streams"].is_array()) {
        note_malformed("meta has no streams");
        return;
    }
    knows_the_run_ = true;
    provenance_ = stream::provenance_of_meta(meta);
    std::vector<std::string> names;
    for (const Json& stream : meta["streams"]) {
        names.push_back(printable(text_in(stream, "name")));
        if (names.back() == row_of(tap_).name && stream.contains("channels") &&
            stream["channels"].is_number_unsigned()) {
            announced_channels_ = stream["channels"].get<std::size_t>();
        }
    }
    if (std::ranges::find(names, row_of(tap_).name) == names.end()) {
        notify_(
            fmt::format("this run has no stream {}; it has {}", row_of(tap_).name, comma_separated(names)));
        end(EndReason::no_such_stream);
    }
}

void ListenSession::take_end(const stream::Message& message) {
    const Json summary = message.parts() == 1 ? parsed_object(message.text(0)) : Json(nullptr);
    if (!summary.is_object()) {
        note_malformed("end has no summary");
        return;
    }
    if (heard_samples() && text_in(summary, "run") != run_) {
        return;
    }
    // No later frame shows what is missing after the last one that came.
    if (heard_samples()) {
        if (const std::uint64_t total = count_in(summary, "samples"); total > next_sample_) {
            missing_at_end_ = total - next_sample_;
            notify_(fmt::format("{} samples are missing before the end", missing_at_end_));
        }
        if (const std::uint64_t dropped = check_.take_end(count_in(summary, "dropped_frames")); dropped > 0) {
            notify_(fmt::format("{} frames were dropped by the sender before the end", dropped));
        }
    }
    end(EndReason::end_of_run);
}

void ListenSession::begin(const stream::FrameHeader& header) {
    run_ = header.run;
    fs_ = header.fs;
    channels_ = header.channels;
    first_sample_ = header.sample;
    stream::RecordingHead head{.columns = {},
                               .sample_rate_hz = fs_,
                               .numbers = stream::NumberType::float32,
                               .provenance = provenance_,
                               .full_scale = request_.full_scale};
    if (!request_.files.empty()) {
        head.columns = stream::recorded_columns(tap_, channels_);
    }
    recordings_.emplace(request_.files, head, stream::RecordingPatience::of_a_second(stop_asked()), notify_);
    if (first_sample_ > 0) {
        notify_(fmt::format("joined run {} at sample {}", run_, first_sample_));
    }
}

bool ListenSession::belongs_to_run(const stream::FrameHeader& header) {
    if (!heard_samples()) {
        return true;
    }
    if (header.run != run_) {
        notify_(fmt::format("run {} broke off and another one began", run_));
        end(EndReason::run_broke_off);
        return false;
    }
    if (header.fs != fs_ || header.channels != channels_) {
        note_malformed("rate or channels changed within the run");
        return false;
    }
    return true;
}

void ListenSession::take_frame(const stream::Message& message) {
    if (message.parts() != 2) {
        note_malformed(fmt::format("found {} parts after the topic, expected 2", message.parts()));
        return;
    }
    const auto header = stream::decode_header(message.text(0), message.bytes(1).size());
    if (!header) {
        note_malformed(header.error());
        return;
    }
    if (!belongs_to_run(*header)) {
        return;
    }
    if (const auto fault = samples_fault(*header, message.bytes(1))) {
        note_malformed(*fault);
        return;
    }
    const stream::ContinuityTotals before = check_.totals();
    const stream::Arrival arrival = check_.take(*header);
    note_arrival(arrival, notice(arrival, *header, next_sample_, before, check_.totals()));
    if (arrival == stream::Arrival::repeated || arrival == stream::Arrival::out_of_order ||
        arrival == stream::Arrival::inconsistent) {
        return;
    }
    if (arrival == stream::Arrival::joined || arrival == stream::Arrival::new_run) {
        begin(*header);
    }
    next_sample_ = header->sample + header->n;
    take_samples(*header);
}

std::optional<std::string> ListenSession::samples_fault(const stream::FrameHeader& header,
                                                        std::span<const std::byte> payload) {
    const bool of_chain = row_of(tap_).extent == Extent::per_sphere;
    const std::size_t most =
        announced_channels_.value_or(of_chain ? static_cast<std::size_t>(max_spheres) : 1);
    if (header.channels > most || (announced_channels_ && header.channels != most)) {
        return fmt::format("found {} channels, expected {}{}", header.channels,
                           announced_channels_ ? "" : "at most ", most);
    }
    if (!stream::decode_samples(payload, values_)) {
        return "the payload does not fill whole samples";
    }
    if (!std::ranges::all_of(values_, [](float value) { return std::isfinite(value); })) {
        return fmt::format("a number of frame {} is not finite", header.seq);
    }
    return std::nullopt;
}

void ListenSession::take_samples(const stream::FrameHeader& header) {
    std::size_t count = header.n;
    if (wanted_s_) {
        const double wanted = std::max(1.0, std::round(*wanted_s_ * fs_));
        const double left = wanted - static_cast<double>(samples_);
        if (left <= static_cast<double>(count)) {
            count = static_cast<std::size_t>(left);
            end(EndReason::heard_enough);
        }
    }
    if (recordings_->any_left()) {
        const auto end = values_.begin() + static_cast<std::ptrdiff_t>(count * channels_);
        recordings_->write(static_cast<std::int64_t>(header.sample), {values_.begin(), end});
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

bool ListenSession::sound() const noexcept {
    const bool whole = end_reason_ != EndReason::silence && end_reason_ != EndReason::run_broke_off &&
                       end_reason_ != EndReason::refused;
    return heard_samples() && check_.gapless() && missing_at_end_ == 0 && malformed_ == 0 && whole;
}

std::string ListenSession::text() const {
    return check_.text() +
           (missing_at_end_ > 0 ? fmt::format(", {} samples missing at the end", missing_at_end_) : "") +
           (malformed_ > 0 ? fmt::format(", {} messages malformed", malformed_) : "");
}

Json ListenSession::summary() const {
    const stream::ContinuityTotals& totals = check_.totals();
    Json summary;
    summary["stream"] = row_of(tap_).name;
    summary["run"] = run_;
    summary["fs"] = fs_;
    summary["channels"] = channels_;
    summary["first_sample"] = first_sample_;
    summary["simulated_s"] = simulated_s();
    summary["samples"] = samples_;
    summary["frames"] = totals.frames;
    summary["missing_samples"] = totals.missing_samples + missing_at_end_;
    summary["frames_dropped_by_sender"] = totals.dropped_by_sender;
    summary["frames_lost_on_the_way"] = totals.lost_on_the_way;
    summary["frames_repeated"] = totals.repeated;
    summary["frames_out_of_order"] = totals.out_of_order;
    summary["frames_inconsistent"] = totals.inconsistent;
    summary["messages_malformed"] = malformed_;
    summary["recordings"] = recordings_ ? stream::recordings_json(*recordings_) : Json::array();
    summary["gapless"] = sound();
    summary["ended_by"] = word(end_reason_);
    return summary;
}

}  // namespace hertzline::app
