#include "scope/pictures/hearing.hpp"

#include <stdexcept>
#include <string_view>
#include <utility>

#include "measures/provenance.hpp"
#include <fmt/format.h>

#include "core/scene/json.hpp"
#include "stream/wire/topics.hpp"

namespace hertzline::scope {

namespace {

constexpr double running_says_something_within_s = 2;  // meters come ten times a second, meta once
constexpr std::size_t largest_json = std::size_t{1} << 20;
constexpr std::chrono::milliseconds longest_turn{2};

Json parsed(const stream::Message& message) {
    if (message.parts() != 1 || message.text(0).size() > largest_json) {
        return nullptr;
    }
    try {
        Json json = json_from_outside(message.text(0));
        return json.is_object() ? json : Json(nullptr);
    } catch (const std::runtime_error&) {
        return nullptr;
    }
}

const Json* member(const Json* object, const char* key) {
    if (object == nullptr || !object->is_object()) {
        return nullptr;
    }
    const auto found = object->find(key);
    return found == object->end() ? nullptr : &*found;
}

double number_in_drive(const Json& meta, const char* key) {
    const Json* number = member(member(member(&meta, "scene"), "drive"), key);
    const double value = number != nullptr && number->is_number() ? number->get<double>() : 0;
    return value > 0 && value < 1e15 ? value : 0;
}

std::string text_of(const Json* json) {
    return json != nullptr && json->is_string() ? json->get<std::string>() : std::string();
}

}  // namespace

Hearing::Hearing(std::string endpoint, const stream::SubscriberOptions& options, TakeFrame take)
    : endpoint_(std::move(endpoint)), subscriber_(endpoint_, options), take_frame_(std::move(take)) {
    for (const std::string_view topic : {stream::meta_topic, stream::meters_topic, stream::end_topic}) {
        subscriber_.subscribe(topic);
    }
}

stream::ReceivedRun Hearing::new_run(Tap tap) {
    return {tap, [](const std::string& /*text*/) {}};  // the account says it in numbers
}

void Hearing::want(TapSet taps) {
    for (const Tap tap : taps) {
        if (!runs_.contains(tap)) {
            runs_.emplace(tap, new_run(tap));
            subscriber_.subscribe(stream::topics_of(tap).np);
        }
    }
    std::erase_if(runs_, [&](const auto& run) {
        if (taps.contains(run.first)) {
            return false;
        }
        subscriber_.unsubscribe(stream::topics_of(run.first).np);
        return true;
    });
}

void Hearing::listen(std::chrono::milliseconds patience) {
    const Clock::time_point enough = Clock::now() + std::max(patience, longest_turn);
    const stream::Message* message = subscriber_.receive(patience);
    while (message != nullptr) {
        take(*message);
        if (Clock::now() >= enough) {
            break;
        }
        message = subscriber_.receive(std::chrono::milliseconds(0));
    }
    if (const auto refusal = subscriber_.refusal()) {
        refusal_ = refusal->reason;
        refused_ = refusal->final;
    }
}

void Hearing::take(const stream::Message& message) {
    last_heard_ = Clock::now();
    refusal_.clear();
    if (message.topic() == stream::meters_topic) {
        if (Json meters = parsed(message); !meters.is_null()) {
            meters_ = std::move(meters);
            ended_ = false;
        }
        return;
    }
    if (message.topic() == stream::meta_topic) {
        take_meta(message);
    }
    ended_ = message.topic() == stream::end_topic;
    for (auto& [tap, run] : runs_) {
        if (message.topic() == stream::topics_of(tap).np) {
            take_frame(run, message);
        } else if (message.topic() == stream::meta_topic || message.topic() == stream::end_topic) {
            run.take(message);
        }
    }
}

void Hearing::take_meta(const stream::Message& message) {
    if (message.parts() == 1 && message.text(0) == meta_text_) {
        return;
    }
    Json meta = parsed(message);
    if (meta.is_null()) {
        return;
    }
    if (text_of(member(&meta, "run")) != text_of(member(&meta_, "run"))) {
        for (auto& [tap, run] : runs_) {
            run = new_run(tap);
        }
        meters_ = nullptr;
    }
    meta_ = std::move(meta);
    meta_text_ = message.text(0);
    ++meta_number_;
    const Json* epoch = member(&meta_, "epoch");
    epoch_ = epoch != nullptr && epoch->is_number_unsigned() ? epoch->get<std::uint32_t>() : 0;
    repetition_hz_ = number_in_drive(meta_, "repetition_hz");
    fundamental_hz_ = number_in_drive(meta_, "frequency_hz");
}

void Hearing::take_frame(stream::ReceivedRun& run, const stream::Message& message) {
    const stream::ReceivedFrame* frame = run.take(message);
    if (run.end_reason() == stream::EndReason::run_broke_off) {
        run = new_run(run.tap());
        frame = run.take(message);
    }
    if (frame != nullptr) {
        take_frame_(run, *frame);
    }
}

double Hearing::silence_s() const {
    return std::chrono::duration<double>(Clock::now() - *last_heard_).count();
}

Hearing::State Hearing::state() const {
    if (refused_ && !refusal_.empty()) {
        return State::refused;
    }
    if (!last_heard_) {
        return State::waiting;
    }
    if (ended_) {
        return State::ended;
    }
    return silence_s() > running_says_something_within_s ? State::silent : State::running;
}

std::string Hearing::state_text() const {
    const std::string reason = refusal_.empty() ? "" : fmt::format(" Last attempt: {}.", refusal_);
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
            return fmt::format("{} does not talk to this scope: {}.", endpoint_, refusal_);
    }
    return "";
}

Json Hearing::account(Tap tap) const {
    const auto run = runs_.find(tap);
    return run == runs_.end() ? Json(nullptr) : run->second.account();
}

}  // namespace hertzline::scope
