#pragma once
// A stream as a listener receives it: one tap of one run, from its meta to its end, with an account of what is missing. Messages come
// from outside and are not trusted.

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/scene/json.hpp"
#include "core/taps.hpp"
#include "stream/wire/continuity.hpp"
#include "stream/wire/frame.hpp"
#include "stream/wire/subscriber.hpp"
#include "stream/wire/topics.hpp"

namespace hertzline::stream {

/// Why listening ended.
enum class EndReason {
    none,
    end_of_run,
    heard_enough,
    stopped,
    silence,
    run_broke_off,
    no_such_stream,
    refused
};

/// As summaries have it ("ended_by").
const char* word(EndReason reason);

/// A frame that was received in order.
struct ReceivedFrame {
    FrameHeader header;
    std::vector<float> values;  ///< row-major, [sample][channel]; all finite
    std::uint64_t missing = 0;  ///< samples between the frame before and this one
};

/// Takes a listener's messages and gives the frames in them.
class ReceivedRun {
public:
    /// Takes a message for the user, as things happen.
    using Notify = std::function<void(const std::string&)>;

    ReceivedRun(Tap tap, Notify notify);

    /// Takes the next message. Afterwards end_reason() says whether it was the last one.
    /// @returns the frame that it was; nothing when it was another message, or one that is not to be used. Its values may be taken.
    ReceivedFrame* take(const Message& message);

    /// Takes a failed handshake: the end when there will be no other.
    void note_refusal(const Refusal& refusal);

    void end(EndReason reason) noexcept { end_reason_ = reason; }
    EndReason end_reason() const noexcept { return end_reason_; }

    /// Something was received, and nothing was missing, odd or cut short.
    bool sound() const noexcept;

    /// The stream has said what it is: its frames may be subscribed to.
    bool knows_the_run() const noexcept { return knows_the_run_; }
    /// The topic of the frames.
    std::string_view topic() const noexcept { return topics_of(tap_).np; }
    Tap tap() const noexcept { return tap_; }

    bool heard_samples() const noexcept { return check_.totals().frames > 0; }
    const ContinuityTotals& totals() const noexcept { return check_.totals(); }
    std::uint64_t missing_at_end() const noexcept { return missing_at_end_; }
    std::uint64_t malformed() const noexcept { return malformed_; }
    /// What meta says of where the samples come from.
    const Json& provenance() const noexcept { return provenance_; }
    /// Changes of the scene that were heard of since the last call, as meta has them; those before the first frame are in
    /// provenance().
    std::vector<Json> take_changes() { return std::exchange(changes_, {}); }
    /// Why the last handshake failed; empty: none did.
    const std::string& refusal() const noexcept { return refusal_; }
    /// Names of the streams that the run has, once it is known.
    const std::vector<std::string>& streams() const noexcept { return streams_; }

    /// Of the frames; 0 and "" before the first one.
    const std::string& run() const noexcept { return run_; }
    double fs() const noexcept { return fs_; }
    std::size_t channels() const noexcept { return channels_; }
    std::uint64_t first_sample() const noexcept { return first_sample_; }

    /// Frames that came, and what was missing or odd, by the names of docs/measures.md.
    Json account() const;
    /// What was received and what was not, as a line.
    std::string text() const;

private:
    ReceivedFrame* take_frame(const Message& message);
    void take_meta(const Message& message);
    void take_end(const Message& message);
    void note_changes(const Json& meta);
    /// The frame is of this run; else says why not.
    bool belongs_to_run(const FrameHeader& header);
    void begin(const FrameHeader& header);
    /// What is wrong with the frame's channels and samples; unset: nothing.
    std::optional<std::string> samples_fault(const FrameHeader& header, std::span<const std::byte> payload);
    void note_malformed(const std::string& reason);
    void note_arrival(Arrival arrival, const std::string& text);

    Tap tap_;
    Notify notify_;
    ContinuityCheck check_;
    Json provenance_ = Json::object();
    EndReason end_reason_ = EndReason::none;
    bool knows_the_run_ = false;
    std::int64_t epoch_ = 0;  // of the last meta
    std::vector<Json> changes_;
    std::vector<std::string> streams_;
    std::optional<std::size_t> announced_channels_;  // as meta says
    std::map<Arrival, int> notices_;                 // so often the user was told of it

    std::string run_;
    double fs_ = 0;
    std::size_t channels_ = 0;
    std::uint64_t first_sample_ = 0;
    std::uint64_t next_sample_ = 0;

    std::uint64_t missing_at_end_ = 0;
    std::uint64_t malformed_ = 0;
    std::string refusal_;  // the last one that the user was told
    ReceivedFrame frame_;
};

}  // namespace hertzline::stream
