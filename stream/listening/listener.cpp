#include "stream/listening/listener.hpp"

#include <algorithm>
#include <limits>
#include <string_view>
#include <utility>

#include "stream/wire/topics.hpp"

namespace hertzline::stream {

Listener::Listener(const std::string& endpoint, ListenerOptions options)
    : options_(std::move(options)),
      subscriber_(std::in_place, endpoint, SubscriberOptions{.curve = options_.curve}) {
    if (!options_.notify) {
        options_.notify = [](const std::string& /*notice*/) {};
    }
    subscriber_->subscribe(meta_topic);
    subscriber_->subscribe(end_topic);
    want(options_.taps);
}

void Listener::want(TapSet taps) {
    for (const Tap tap : taps) {
        if (runs_.try_emplace(tap, new_run(tap)).second && introduced_) {
            subscriber_->subscribe(topics_of(tap).np);
        }
    }
    std::erase_if(runs_, [&](const auto& run) {
        const bool unwanted = !taps.contains(run.first);
        if (unwanted && introduced_) {
            subscriber_->unsubscribe(topics_of(run.first).np);
        }
        return unwanted;
    });
}

ReceivedFrame* Listener::receive(std::chrono::milliseconds patience) {
    if (!subscriber_ || ended()) {
        return nullptr;
    }
    using Clock = std::chrono::steady_clock;
    const Clock::time_point start = Clock::now();
    // not beyond the silence that ends listening, and a millisecond more
    const double left_ms = std::min(1e3 * std::max(0.0, timeout_s() - silence_.count()) + 1, 1e9);
    patience = std::min(patience, std::chrono::milliseconds(static_cast<std::int64_t>(left_ms)));
    ReceivedFrame* frame = nullptr;
    if (const Message* message = subscriber_->receive(patience)) {
        frame = take(*message);
    } else {
        // Between calls nothing has come, either. Of a program that was suspended only a second counts: messages may be on their way.
        const Clock::time_point now = Clock::now();
        silence_ +=
            std::min(now - looked_at_, std::max<Clock::duration>(now - start, std::chrono::seconds(1)));
        if (silence_.count() > timeout_s()) {
            end(EndReason::silence);
        }
    }
    looked_at_ = Clock::now();
    if (auto refusal = subscriber_->refusal()) {
        for (auto& [tap, run] : runs_) {
            run.note_refusal(*refusal);
        }
        refusal_ = std::move(refusal);
    }
    return frame;
}

ReceivedFrame* Listener::take(const Message& message) {
    silence_ = {};
    refusal_.reset();
    if (options_.on_message) {
        options_.on_message(message);
    }
    ReceivedFrame* frame = nullptr;
    for (auto& [tap, run] : runs_) {
        if (ReceivedFrame* taken = take(run, message)) {
            frame = taken;
        }
    }
    const auto knows_the_run = [](const auto& run) { return run.second.knows_the_run(); };
    if (!introduced_ && message.topic() == meta_topic && std::ranges::all_of(runs_, knows_the_run)) {
        introduced_ = true;
        for (const auto& [tap, run] : runs_) {
            subscriber_->subscribe(run.topic());
        }
    }
    return frame;
}

ReceivedFrame* Listener::take(RunReceiver& run, const Message& message) {
    if (options_.runs == ListenerOptions::Runs::one && run.end_reason() != EndReason::none) {
        return nullptr;  // others may still go on
    }
    ReceivedFrame* frame = run.take(message);
    if (options_.runs == ListenerOptions::Runs::every && run.end_reason() == EndReason::run_broke_off) {
        run = new_run(run.tap());
        frame = run.take(message);
    }
    return frame;
}

void Listener::begin_anew() {
    for (auto& [tap, run] : runs_) {
        run = new_run(tap);
    }
}

void Listener::end(EndReason reason) {
    for (auto& [tap, run] : runs_) {
        if (run.end_reason() == EndReason::none) {
            run.end(reason);
        }
    }
}

void Listener::close() {
    subscriber_.reset();
    end(EndReason::stopped);
}

bool Listener::ended() const noexcept {
    const auto has_ended = [](const auto& run) { return run.second.end_reason() != EndReason::none; };
    return options_.runs == ListenerOptions::Runs::one && std::ranges::all_of(runs_, has_ended);
}

double Listener::timeout_s() const noexcept {
    // As long as Subscriber takes to notice that a machine is gone.
    constexpr double once_samples_have_come = 15;
    constexpr double no_limit = std::numeric_limits<double>::infinity();
    const auto has_samples = [](const auto& run) { return run.second.has_samples(); };
    if (options_.runs == ListenerOptions::Runs::every) {
        return no_limit;
    }
    return options_.timeout_s.value_or(std::ranges::any_of(runs_, has_samples) ? once_samples_have_come
                                                                               : no_limit);
}

}  // namespace hertzline::stream
