#pragma once
// Listens at one endpoint while the scope runs: receives the wanted streams of every run there, and explains a silence.

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "core/scene/json.hpp"
#include "hertzline/taps.hpp"
#include "stream/listening/listener.hpp"

namespace hertzline::scope {

/// For one thread.
class LiveListener {
public:
    enum class State {
        waiting,  ///< no message has come yet
        running,
        ended,    ///< its end was the last message
        silent,   ///< no message for two seconds, and no end
        refused,  ///< the publisher refuses the connection for good
    };
    /// Takes each frame of the wanted streams.
    using TakeFrame = std::function<void(stream::RunReceiver&, const stream::ReceivedFrame&)>;

    /// Connects. @throws std::runtime_error as Listener does
    LiveListener(std::string endpoint, const std::optional<stream::CurveClient>& curve, TakeFrame take);

    /// Replaces the wanted streams. One that the run does not have may come with the next run.
    void want(TapSet taps) { listener_.want(taps); }

    /// Waits at most so long for a message, and takes all that have arrived.
    void listen(std::chrono::milliseconds patience);

    State state() const;
    /// Returns the state in a sentence or two, with advice; empty: running.
    std::string state_text() const;

    /// Returns the last meta and meters; null: none.
    const Json& meta() const noexcept { return meta_; }
    const Json& meters() const noexcept { return meters_; }
    /// Returns a count of the metas that differ from the one before.
    std::uint64_t meta_number() const noexcept { return meta_number_; }

    /// Returns a count of the runs: samples belong to the last one.
    std::uint64_t run_number() const noexcept { return run_number_; }

    /// Returns the run's id; empty: unknown.
    std::string run_id() const { return OutsideJson(meta_).text("run"); }
    /// Returns a frequency of the scene's drive [Hz]; 0: unknown, or none.
    double repetition_hz() const noexcept { return repetition_hz_; }
    double fundamental_hz() const noexcept { return fundamental_hz_; }
    /// Returns the count of changes of the scene; 0 for a stream without control.
    std::uint32_t epoch() const noexcept { return epoch_; }

    /// Returns RunReceiver::account() of a stream in this run; null: it is not wanted.
    Json account(Tap tap) const;

private:
    using Clock = std::chrono::steady_clock;

    void take(const stream::Message& message);
    void take_meta(const stream::Message& message);
    double silence_s() const;

    std::string endpoint_;
    TakeFrame take_frame_;
    Json meta_;
    Json meters_;
    std::string meta_text_;
    std::uint64_t meta_number_ = 0;
    std::uint64_t run_number_ = 0;
    double repetition_hz_ = 0;
    double fundamental_hz_ = 0;
    std::uint32_t epoch_ = 0;
    std::optional<Clock::time_point> last_message_;
    bool ended_ = false;
    bool more_ = false;  // a message came with the last call
    stream::Listener listener_;
};

}  // namespace hertzline::scope
