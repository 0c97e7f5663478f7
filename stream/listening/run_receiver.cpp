#include "stream/listening/run_receiver.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "core/scene/json.hpp"
#include "core/scene/text.hpp"
#include "hertzline/scene.hpp"
#include "measures/provenance.hpp"
#include "recordings/float32.hpp"
#include "stream/wire/frame_codec.hpp"

namespace hertzline::stream {

namespace {

constexpr int most_notices = 3;  // of a kind; later ones are only counted

/// The notice about a frame; empty: none.
/// @param expected the sample that was due @param before the totals without this frame, `now` with it
std::string notice(Arrival arrival, const FrameHeader& frame, std::uint64_t expected,
                   const ContinuityTotals& before, const ContinuityTotals& now) {
    switch (arrival) {
        case Arrival::joined:
        case Arrival::new_run:
        case Arrival::in_order:
            return "";
        case Arrival::gap:
            return fmt::format(
                "{} samples are missing before sample {}: {} frames dropped by the sender, {} lost on the "
                "way",
                frame.sample - expected, frame.sample, now.dropped_by_sender - before.dropped_by_sender,
                now.lost_on_the_way - before.lost_on_the_way);
        case Arrival::repeated:
            return fmt::format("frame {} arrived twice", frame.seq);
        case Arrival::out_of_order:
            return fmt::format("frame {} arrived after a later one", frame.seq);
        case Arrival::inconsistent:
            return fmt::format("frame {} is inconsistent: found sample {}, expected {}", frame.seq,
                               frame.sample, expected);
    }
    return "";
}

}  // namespace

const char* word(EndReason reason) {
    switch (reason) {
        case EndReason::none:
            return "";
        case EndReason::end_of_run:
            return "end of run";
        case EndReason::long_enough:
            return "duration";
        case EndReason::stopped:
            return "stopped";
        case EndReason::silence:
            return "timeout";
        case EndReason::run_broke_off:
            return "run broke off";
        case EndReason::no_such_stream:
            return "no such stream";
        case EndReason::refused:
            return "refused";
    }
    return "";
}

RunReceiver::RunReceiver(Tap tap, Notify notify) : tap_(tap), notify_(std::move(notify)) {}

ReceivedFrame* RunReceiver::take(const Message& message) {
    if (message.topic() == topic()) {
        return take_frame(message);
    }
    if (message.topic() == meta_topic) {
        take_meta(message);
    } else if (message.topic() == end_topic) {
        take_end(message);
    }
    return nullptr;
}

void RunReceiver::note_malformed(const std::string& reason) {
    if (++malformed_ == 1) {  // a peer that sends nonsense sends a lot of it
        notify_("malformed message: " + reason);
    }
}

void RunReceiver::note_arrival(Arrival arrival, const std::string& text) {
    if (int& count = notices_[arrival]; !text.empty() && ++count <= most_notices) {
        notify_(text + (count == most_notices ? " (more of these are only counted)" : ""));
    }
}

void RunReceiver::note_refusal(const Refusal& refusal) {
    refusal_ = refusal.reason;
    if (told_refusals_.insert(refusal.reason).second) {  // ZeroMQ tries several times a second
        notify_(refusal.reason);
    }
    if (refusal.final) {
        end(EndReason::refused);
    }
}

void RunReceiver::take_meta(const Message& message) {
    if (message.parts() != 1) {
        return;
    }
    const Json meta = object_from_outside(message.text(0), largest_scene_json);
    if (has_samples()) {
        note_changes(meta);
        return;
    }
    const Json& streams = OutsideJson(meta).at("streams");
    if (!streams.is_array()) {
        note_malformed("meta has no streams");
        return;
    }
    knows_the_run_ = true;
    epoch_ = OutsideJson(meta).count("epoch").value_or(0);
    provenance_ = measures::provenance_of_meta(meta);
    streams_.clear();
    for (const Json& json : streams) {
        const OutsideJson stream(json);
        streams_.push_back(printable(stream.text("name")));
        if (const auto channels = stream.count("channels");
            channels && streams_.back() == row_of(tap_).name) {
            announced_channels_ = static_cast<std::size_t>(*channels);
        }
    }
    if (std::ranges::find(streams_, row_of(tap_).name) == streams_.end()) {
        notify_(fmt::format("this run has no stream {}; it has {}", row_of(tap_).name,
                            comma_separated(streams_)));
        end(EndReason::no_such_stream);
    }
}

/// Meta comes before the first frame of an epoch.
void RunReceiver::note_changes(const Json& meta) {
    const Json& changes = OutsideJson(meta).at("changes");
    if (OutsideJson(meta).text("run") != run_ || !changes.is_array()) {
        return;
    }
    for (const Json& change : changes) {
        if (const std::int64_t number = OutsideJson(change).count("epoch").value_or(0); number > epoch_) {
            epoch_ = number;
            changes_.push_back(change);
        }
    }
}

void RunReceiver::take_end(const Message& message) {
    const Json summary = message.parts() == 1 ? object_from_outside(message.text(0)) : Json(nullptr);
    if (!summary.is_object()) {
        note_malformed("end has no summary");
        return;
    }
    const OutsideJson outside(summary);
    const auto count = [&](std::string_view key) {
        return static_cast<std::uint64_t>(outside.count(key).value_or(0));
    };
    if (has_samples() && outside.text("run") != run_) {
        return;
    }
    // No later frame shows the samples that are missing after the last one.
    if (has_samples()) {
        if (const std::uint64_t total = count("samples"); total > next_sample_) {
            missing_at_end_ = total - next_sample_;
            notify_(fmt::format("{} samples are missing before the end", missing_at_end_));
        }
        const std::string of_topic = fmt::format("{}_np_dropped", row_of(tap_).name);
        if (const std::uint64_t dropped = check_.take_end(count(of_topic)); dropped > 0) {
            notify_(fmt::format("{} frames were dropped by the sender before the end", dropped));
        }
    }
    end(EndReason::end_of_run);
}

void RunReceiver::begin(const FrameHeader& header) {
    run_ = header.run;
    fs_ = header.fs;
    channels_ = header.channels;
    first_sample_ = header.sample;
    if (first_sample_ > 0) {
        notify_(fmt::format("joined run {} at sample {}", run_, first_sample_));
    }
}

bool RunReceiver::belongs_to_run(const FrameHeader& header) {
    if (!has_samples()) {
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

ReceivedFrame* RunReceiver::take_frame(const Message& message) {
    if (message.parts() != 2) {
        note_malformed(fmt::format("found {} parts after the topic, expected 2", message.parts()));
        return nullptr;
    }
    const auto header = decode_header(message.text(0), message.bytes(1).size());
    if (!header) {
        note_malformed(header.error());
        return nullptr;
    }
    if (!belongs_to_run(*header)) {
        return nullptr;
    }
    if (const auto fault = samples_fault(*header, message.bytes(1))) {
        note_malformed(*fault);
        return nullptr;
    }
    const ContinuityTotals before = check_.totals();
    const Arrival arrival = check_.take(*header);
    note_arrival(arrival, notice(arrival, *header, next_sample_, before, check_.totals()));
    if (arrival == Arrival::repeated || arrival == Arrival::out_of_order ||
        arrival == Arrival::inconsistent) {
        return nullptr;
    }
    if (arrival == Arrival::joined || arrival == Arrival::new_run) {
        begin(*header);
    }
    frame_.tap = tap_;
    frame_.missing = arrival == Arrival::gap ? header->sample - next_sample_ : 0;
    frame_.header = *header;
    next_sample_ = header->sample + header->n;
    return &frame_;
}

std::optional<std::string> RunReceiver::samples_fault(const FrameHeader& header,
                                                      std::span<const std::byte> payload) {
    const std::size_t most = announced_channels_.value_or(channels_of(
        tap_,
        {.spheres = static_cast<std::size_t>(max_spheres), .points = max_points, .elements = max_elements}));
    if (header.channels > most || (announced_channels_ && header.channels != most)) {
        return fmt::format("found {} channels, expected {}{}", header.channels,
                           announced_channels_ ? "" : "at most ", most);
    }
    if (!recordings::decode_samples(payload, frame_.values)) {
        return "the payload does not fill whole samples";
    }
    if (!std::ranges::all_of(frame_.values, [](float value) { return std::isfinite(value); })) {
        return fmt::format("a number of frame {} is not finite", header.seq);
    }
    return std::nullopt;
}

bool RunReceiver::complete() const noexcept {
    const bool whole = end_reason_ != EndReason::silence && end_reason_ != EndReason::run_broke_off &&
                       end_reason_ != EndReason::refused;
    return has_samples() && check_.gapless() && missing_at_end_ == 0 && malformed_ == 0 && whole;
}

Json RunReceiver::account() const {
    const ContinuityTotals& counted = totals();
    return {{"frames", counted.frames},
            {"missing_samples", counted.missing_samples + missing_at_end_},
            {"frames_dropped_by_sender", counted.dropped_by_sender},
            {"frames_lost_on_the_way", counted.lost_on_the_way},
            {"frames_repeated", counted.repeated},
            {"frames_out_of_order", counted.out_of_order},
            {"frames_inconsistent", counted.inconsistent},
            {"messages_malformed", malformed_}};
}

std::string RunReceiver::text() const {
    return check_.text() +
           (missing_at_end_ > 0 ? fmt::format(", {} samples missing at the end", missing_at_end_) : "") +
           (malformed_ > 0 ? fmt::format(", {} messages malformed", malformed_) : "");
}

}  // namespace hertzline::stream
