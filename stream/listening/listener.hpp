#pragma once
// Listens to a stream: connects, waits for meta, subscribes to the wanted taps, and gives their frames.

#include <chrono>
#include <functional>
#include <map>
#include <optional>
#include <string>

#include "hertzline/taps.hpp"
#include "stream/listening/run_receiver.hpp"
#include "stream/wire/security/curve.hpp"
#include "stream/wire/subscriber.hpp"

namespace hertzline::stream {

struct ListenerOptions {
    enum class Runs {
        one,   ///< listening ends with the run
        every  ///< never ends: each run is followed by the next
    };

    TapSet taps = Tap::v_out;
    Runs runs = Runs::one;
    /// A longer silence ends listening [s]; unset: 15 s once samples have come, no limit before. A stream that runs sends its meta
    /// once a second, so a silent one was killed, or its end was lost in a full queue.
    std::optional<double> timeout_s{};
    /// Encrypts, and listens to the owner of this key only; unset: plain.
    std::optional<CurveClient> curve{};
    /// Takes notices for the user: a gap, a failed handshake.
    RunReceiver::Notify notify{};
    /// Takes every message before its frame is decoded.
    std::function<void(const Message&)> on_message{};
};

/// A connection to one publisher. For one thread.
class Listener {
public:
    /// Connects; an absent publisher is waited for. @throws std::runtime_error that names the endpoint and its fault
    explicit Listener(const std::string& endpoint, ListenerOptions options = {});

    /// Replaces the wanted taps. A tap that the run does not have may come with the next one.
    void want(TapSet taps);
    /// Subscribes to one more topic, for on_message.
    void subscribe(std::string_view topic) { subscriber_->subscribe(topic); }

    /// Waits for one message.
    /// @returns the frame in it, valid until the next call, whose values may be taken; null when it holds none, none came in time, or
    /// listening has ended
    ReceivedFrame* receive(std::chrono::milliseconds patience);

    /// Forgets the received run: another one has begun.
    void begin_anew();
    /// Ends listening with a reason, unless it has ended.
    void end(EndReason reason);
    /// Disconnects, and ends listening.
    void close();

    /// The run has ended for every wanted tap.
    bool ended() const noexcept;
    /// Longest silence at present [s]; infinite: no limit.
    double timeout_s() const noexcept;

    /// The receiver of the only tap.
    RunReceiver& run() { return runs_.begin()->second; }
    const RunReceiver& run() const { return runs_.begin()->second; }
    /// The receivers of all wanted taps.
    std::map<Tap, RunReceiver>& runs() noexcept { return runs_; }
    const std::map<Tap, RunReceiver>& runs() const noexcept { return runs_; }
    /// The last failed connection, until a message comes.
    const std::optional<Refusal>& refusal() const noexcept { return refusal_; }

private:
    ReceivedFrame* take(const Message& message);
    ReceivedFrame* take(RunReceiver& run, const Message& message);
    RunReceiver new_run(Tap tap) const { return {tap, options_.notify}; }

    ListenerOptions options_;
    std::optional<Subscriber> subscriber_;  // unset: closed
    std::map<Tap, RunReceiver> runs_;
    bool introduced_ = false;  // meta has come; a frame before it would not be known
    std::chrono::duration<double> silence_{};
    std::chrono::steady_clock::time_point looked_at_ = std::chrono::steady_clock::now();
    std::optional<Refusal> refusal_;
};

}  // namespace hertzline::stream
