#include "scope/pictures/live_listener.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "stream/wire/topics.hpp"

namespace hertzline::scope {

namespace {

constexpr double longest_pause_s = 2;  // of a running stream: meters come ten times a second, meta once
constexpr std::chrono::milliseconds longest_call{2};

Json object_in(const stream::Message& message) {
    return message.parts() == 1 ? object_from_outside(message.text(0), largest_scene_json) : Json(nullptr);
}

double rate_in(const OutsideJson& meta, const char* path) {
    constexpr double most = 1e15;
    const double rate = meta.number(path).value_or(0);
    return rate > 0 && rate < most ? rate : 0;
}

}  // namespace

LiveListener::LiveListener(std::string endpoint, const std::optional<stream::CurveClient>& curve,
                           TakeFrame take)
    : endpoint_(std::move(endpoint)),
      take_frame_(std::move(take)),
      listener_(endpoint_, {.taps = {},
                            .runs = stream::ListenerOptions::Runs::every,
                            .curve = curve,
                            .on_message = [this](const stream::Message& message) { this->take(message); }}) {
    listener_.subscribe(stream::meters_topic);
}

void LiveListener::listen(std::chrono::milliseconds patience) {
    const Clock::time_point deadline = Clock::now() + std::max(patience, longest_call);
    do {
        more_ = false;
        if (const stream::ReceivedFrame* frame = listener_.receive(patience)) {
            take_frame_(listener_.runs().at(frame->tap), *frame);
        }
        patience = std::chrono::milliseconds(0);
    } while (more_ && Clock::now() < deadline);
}

void LiveListener::take(const stream::Message& message) {
    more_ = true;
    last_message_ = Clock::now();
    if (message.topic() == stream::meters_topic) {
        if (Json meters = object_in(message); !meters.is_null()) {
            meters_ = std::move(meters);
            ended_ = false;
        }
        return;
    }
    ended_ = message.topic() == stream::end_topic;
    if (message.topic() == stream::meta_topic) {
        take_meta(message);
    }
}

void LiveListener::take_meta(const stream::Message& message) {
    if (message.parts() == 1 && message.text(0) == meta_text_) {
        return;
    }
    Json meta = object_in(message);
    if (meta.is_null()) {
        return;
    }
    if (OutsideJson(meta).text("run") != run_id()) {
        listener_.begin_anew();
        meters_ = nullptr;
        ++run_number_;
    }
    meta_ = std::move(meta);
    meta_text_ = message.text(0);
    ++meta_number_;
    const OutsideJson outside(meta_);
    epoch_ = static_cast<std::uint32_t>(outside.count("epoch").value_or(0));
    repetition_hz_ = rate_in(outside, "scene/drive/repetition_hz");
    fundamental_hz_ = rate_in(outside, "scene/drive/frequency_hz");
}

double LiveListener::silence_s() const {
    return std::chrono::duration<double>(Clock::now() - *last_message_).count();
}

LiveListener::State LiveListener::state() const {
    if (listener_.refusal() && listener_.refusal()->final) {
        return State::refused;
    }
    if (!last_message_) {
        return State::waiting;
    }
    if (ended_) {
        return State::ended;
    }
    return silence_s() > longest_pause_s ? State::silent : State::running;
}

std::string LiveListener::state_text() const {
    const std::string refusal = listener_.refusal() ? listener_.refusal()->reason : "";
    const std::string reason = refusal.empty() ? "" : fmt::format(" Last attempt: {}.", refusal);
    switch (state()) {
        case State::waiting:
            return fmt::format(
                "No stream at {} yet. Start one there: hertzline stream paper-stream. It is shown as soon as "
                "it "
                "begins.{}",
                endpoint_, reason);
        case State::running:
            return "";
        case State::ended:
            return fmt::format("The stream at {} has ended. The next one is shown as soon as it begins.",
                               endpoint_);
        case State::silent:
            return fmt::format(
                "Nothing has come from {} for {:.0f} s: the stream was stopped without an end, or cannot be "
                "reached. It is shown again as soon as it is back.{}",
                endpoint_, silence_s(), reason);
        case State::refused:
            return fmt::format("{} does not talk to this scope: {}.", endpoint_, refusal);
    }
    return "";
}

Json LiveListener::account(Tap tap) const {
    const auto run = listener_.runs().find(tap);
    return run == listener_.runs().end() ? Json(nullptr) : run->second.account();
}

}  // namespace hertzline::scope
