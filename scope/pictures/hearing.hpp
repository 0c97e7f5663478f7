#pragma once
// A listener that stays: hears the streams that are wanted, of whatever run is there, and knows what is wrong when none is.

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>

#include "core/scene/json.hpp"
#include "core/taps.hpp"
#include "stream/listening/received_run.hpp"
#include "stream/wire/subscriber.hpp"

namespace hertzline::scope {

/// For one thread.
class Hearing {
public:
    enum class State {
        waiting,  ///< nothing was ever heard
        running,
        ended,    ///< its end was heard, and nothing since
        silent,   ///< it has said nothing for two seconds, and no end
        refused,  ///< the other side does not talk to us, and never will
    };
    /// Takes each frame of the streams that are wanted.
    using TakeFrame = std::function<void(stream::ReceivedRun&, const stream::ReceivedFrame&)>;

    /// Connects. @throws std::runtime_error as Subscriber does
    Hearing(std::string endpoint, const stream::SubscriberOptions& options, TakeFrame take);

    /// The streams that are wanted from now on; those that the run has not are waited for.
    void want(TapSet taps);

    /// Waits for a message for so long at most, and takes what waits with it.
    void listen(std::chrono::milliseconds patience);

    State state() const;
    /// What the state means and what to do, in a sentence or two.
    std::string state_text() const;

    /// The last meta and meters; null: none.
    const Json& meta() const noexcept { return meta_; }
    const Json& meters() const noexcept { return meters_; }
    /// Counts the metas that differ from the one before.
    std::uint64_t meta_number() const noexcept { return meta_number_; }

    /// Of the scene, from meta [Hz]; 0: not known, or none.
    double repetition_hz() const noexcept { return repetition_hz_; }
    double fundamental_hz() const noexcept { return fundamental_hz_; }
    /// Counts the changes of the scene; 0 of a stream that takes none.
    std::uint32_t epoch() const noexcept { return epoch_; }

    /// What came and what is missing of a stream in this run, as ReceivedRun::account(); null: it is not wanted.
    Json account(Tap tap) const;

private:
    using Clock = std::chrono::steady_clock;

    void take(const stream::Message& message);
    void take_meta(const stream::Message& message);
    void take_frame(stream::ReceivedRun& run, const stream::Message& message);
    stream::ReceivedRun new_run(Tap tap);
    double silence_s() const;

    std::string endpoint_;
    stream::Subscriber subscriber_;
    TakeFrame take_frame_;
    std::map<Tap, stream::ReceivedRun> runs_;
    Json meta_;
    Json meters_;
    std::string meta_text_;
    std::uint64_t meta_number_ = 0;
    double repetition_hz_ = 0;
    double fundamental_hz_ = 0;
    std::uint32_t epoch_ = 0;
    std::optional<Clock::time_point> last_heard_;
    bool ended_ = false;
    std::string refusal_;
    bool refused_ = false;
};

}  // namespace hertzline::scope
