#include "apps/commands/listen_session.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "core/scene/text.hpp"
#include "stream/provenance.hpp"
#include "stream/recordings/row_builder.hpp"
#include "stream/wire/frame_codec.hpp"

namespace hertzline::app {

namespace {

constexpr std::size_t largest_json = 1 << 20;  // of meta and end; a scene has at most 64 KiB

/// An object, or null when the text is none.
Json parsed_object(std::string_view text) {
    if (text.size() > largest_json) {
        return nullptr;
    }
    // What is nested deeper is dropped as it is read: the library would follow it recursively later.
    const auto shallow = [](int level, Json::parse_event_t, Json&) { return level < 16; };
    Json json = Json::parse(text, shallow, false);
    return json.is_object() ? json : Json(nullptr);
}

std::string text_in(const Json& object, const char* key) {
    const auto found = object.is_object() ? object.find(key) : object.end();
    return object.is_object() && found != object.end() && found->is_string() ? found->get<std::string>() : "";
}

const char* word(Ending ending) {
    switch (ending) {
        case Ending::none:
            return "";
        case Ending::end_of_run:
            return "end of run";
        case Ending::heard_enough:
            return "duration";
        case Ending::stopped:
            return "stopped";
        case Ending::silence:
            return "timeout";
        case Ending::run_broke_off:
            return "run broke off";
        case Ending::no_such_stream:
            return "no such stream";
        case Ending::refused:
            return "refused";
    }
    return "";
}

}  // namespace

Listening::Listening(Tap tap, std::optional<double> wanted_s, std::vector<std::string> files, Tell tell)
    : tap_(tap), wanted_s_(wanted_s), files_(std::move(files)), notify_(std::move(tell)) {}

void Listening::take(const stream::Message& message) {
    if (message.topic() == topic()) {
        take_frame(message);
    } else if (message.topic() == meta_topic) {
        take_meta(message);
    } else if (message.topic() == end_topic) {
        take_end(message);
    }
}

void Listening::note_malformed(const std::string& reason) {
    if (++malformed_ == 1) {  // a peer that sends nonsense sends a lot of it
        notify_("a message that is none of a stream's: " + reason);
    }
}

void Listening::note_refusal(const stream::Refusal& refusal) {
    if (refusal.reason != refusal_) {  // ZeroMQ tries several times a second
        notify_(refusal.reason);
        refusal_ = refusal.reason;
    }
    if (refusal.final) {
        end(Ending::refused);
    }
}

void Listening::take_meta(const stream::Message& message) {
    if (heard_samples() || message.parts() != 1) {
        return;
    }
    const Json meta = parsed_object(message.text(0));
    if (!meta.is_object() || !meta.contains("streams") || !meta["streams"].is_array()) {
        note_malformed("meta without streams");
        return;
    }
    knows_the_run_ = true;
    provenance_ = stream::provenance_of_meta(meta);
    std::vector<std::string> names;
    for (const Json& stream : meta["streams"]) {
        names.push_back(printable(text_in(stream, "name")));
    }
    if (std::ranges::find(names, names_of(tap_).name) == names.end()) {
        notify_(
            fmt::format("this run has no stream {}, it has {}", names_of(tap_).name, comma_separated(names)));
        end(Ending::no_such_stream);
    }
}

void Listening::take_end(const stream::Message& message) {
    const Json summary = message.parts() == 1 ? parsed_object(message.text(0)) : Json(nullptr);
    if (!summary.is_object()) {
        note_malformed("end without a summary");
        return;
    }
    if (heard_samples() && text_in(summary, "run") != run_) {
        return;
    }
    // The queue may have been full to the very end: then no later frame tells of the gap.
    const auto sent = summary.find("samples");
    if (heard_samples() && sent != summary.end() && sent->is_number_integer()) {
        const auto total = sent->get<std::int64_t>();
        if (total > 0 && static_cast<std::uint64_t>(total) > next_sample_) {
            missing_at_end_ = static_cast<std::uint64_t>(total) - next_sample_;
            notify_(fmt::format("{} samples are missing before the end", missing_at_end_));
        }
    }
    end(Ending::end_of_run);
}

void Listening::begin(const stream::FrameHeader& header) {
    run_ = header.run;
    fs_ = header.fs;
    channels_ = header.channels;
    first_sample_ = header.sample;
    const stream::RecordingHead head{.columns = stream::tap_columns(tap_, channels_),
                                     .sample_rate_hz = fs_,
                                     .numbers = stream::NumberType::float32,
                                     .provenance = provenance_};
    recordings_.emplace(files_, head, notify_);
    if (first_sample_ > 0) {
        notify_(fmt::format("joined run {} at sample {}", run_, first_sample_));
    }
}

void Listening::take_frame(const stream::Message& message) {
    if (message.parts() != 2) {
        note_malformed(fmt::format("{} parts after the topic", message.parts()));
        return;
    }
    const auto header = stream::decode_header(message.text(0), message.bytes(1).size());
    if (!header) {
        note_malformed(header.error());
        return;
    }
    if (heard_samples() && header->run != run_) {
        notify_(fmt::format("run {} broke off, another one began", run_));
        end(Ending::run_broke_off);
        return;
    }
    if (heard_samples() && (header->fs != fs_ || header->channels != channels_)) {
        note_malformed("rate or channels changed within the run");
        return;
    }
    const std::uint64_t expected = next_sample_;
    const stream::ContinuityTotals before = check_.totals();
    switch (check_.take(*header)) {
        case stream::Arrival::joined:
        case stream::Arrival::new_run:
            begin(*header);
            break;
        case stream::Arrival::in_order:
            break;
        case stream::Arrival::gap: {
            const stream::ContinuityTotals& now = check_.totals();
            notify_(fmt::format(
                "{} samples are missing before sample {}: {} frames dropped by the sender, {} lost on the "
                "way",
                header->sample - expected, header->sample, now.dropped_by_sender - before.dropped_by_sender,
                now.lost_on_the_way - before.lost_on_the_way));
            break;
        }
        case stream::Arrival::repeated:
            notify_(fmt::format("frame {} came twice", header->seq));
            return;
        case stream::Arrival::out_of_order:
            notify_(fmt::format("frame {} came too late", header->seq));
            return;
        case stream::Arrival::inconsistent:
            notify_(fmt::format("frame {} contradicts itself: sample {} where {} was due", header->seq,
                                header->sample, expected));
            next_sample_ = header->sample + header->n;
            return;
    }
    next_sample_ = header->sample + header->n;
    take_samples(*header, message.bytes(1));
}

void Listening::take_samples(const stream::FrameHeader& header, std::span<const std::byte> payload) {
    std::size_t count = header.n;
    if (wanted_s_) {
        const double wanted = std::max(1.0, std::round(*wanted_s_ * fs_));
        const double left = wanted - static_cast<double>(samples_);
        if (left <= static_cast<double>(count)) {
            count = static_cast<std::size_t>(left);
            end(Ending::heard_enough);
        }
    }
    if (recordings_->any_left()) {
        if (!stream::decode_samples(payload, values_)) {
            note_malformed("a payload of no whole number of samples");
            return;
        }
        const auto end = values_.begin() + static_cast<std::ptrdiff_t>(count * channels_);
        rows_.assign(values_.begin(), end);
        recordings_->write(static_cast<std::int64_t>(header.sample), rows_);
    }
    samples_ += count;
}

void Listening::save() {
    if (recordings_) {
        recordings_->commit();
    }
}

bool Listening::sound() const noexcept {
    const bool whole =
        ending_ != Ending::silence && ending_ != Ending::run_broke_off && ending_ != Ending::refused;
    return heard_samples() && check_.unbroken() && missing_at_end_ == 0 && malformed_ == 0 && whole;
}

std::string Listening::text() const {
    return check_.text() +
           (missing_at_end_ > 0 ? fmt::format(", {} samples missing at the end", missing_at_end_) : "") +
           (malformed_ > 0 ? fmt::format(", {} messages malformed", malformed_) : "");
}

Json Listening::summary() const {
    const stream::ContinuityTotals& totals = check_.totals();
    Json summary;
    summary["stream"] = names_of(tap_).name;
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
    summary["recordings"] = recordings_ ? recordings_json(*recordings_) : Json::array();
    summary["unbroken"] = sound();
    summary["ended_by"] = word(ending_);
    return summary;
}

}  // namespace hertzline::app
