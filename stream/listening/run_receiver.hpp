#pragma once
// Receives one tap of one run, from its meta to its end, and accounts for missing samples. Messages come from outside and are not
// trusted.

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/scene/json.hpp"
#include "hertzline/taps.hpp"
#include "stream/wire/continuity.hpp"
#include "stream/wire/frame_codec.hpp"
#include "stream/wire/subscriber.hpp"
#include "stream/wire/topics.hpp"

namespace hertzline::stream {

/// The reason why listening ended.
enum class EndReason {
    none,
    end_of_run,
    long_enough,
    stopped,
    silence,
    run_broke_off,
    no_such_stream,
    refused
};

/// Returns the word of summaries for it ("ended_by").
const char* word(EndReason reason);

/// A frame that was received in order.
struct ReceivedFrame {
    Tap tap = Tap::v_out;
    FrameHeader header;
    std::vector<float> values;  ///< row-major, [sample][channel]; all finite
    std::uint64_t missing = 0;  ///< samples between the frame before and this one
};

/// Takes the messages of a subscriber and gives the frames in them.
class RunReceiver {
public:
    /// Takes a notice for the user, as things happen.
    using Notify = std::function<void(const std::string&)>;

    RunReceiver(Tap tap, Notify notify);

    /// Takes the next message, which may end the run: see end_reason().
    /// @returns the frame in the message, whose values may be taken; null when it holds none, or a damaged one
    ReceivedFrame* take(const Message& message);

    /// Takes a failed handshake; the run ends when ZeroMQ will not try again.
    void note_refusal(const Refusal& refusal);

    void end(EndReason reason) noexcept { end_reason_ = reason; }
    EndReason end_reason() const noexcept { return end_reason_; }

    /// Samples were received, and none is missing, odd or cut off.
    bool complete() const noexcept;

    /// The run's meta has come.
    bool knows_the_run() const noexcept { return knows_the_run_; }
    /// The topic of the frames.
    std::string_view topic() const noexcept { return topics_of(tap_).np; }
    Tap tap() const noexcept { return tap_; }

    bool has_samples() const noexcept { return check_.totals().frames > 0; }
    const ContinuityTotals& totals() const noexcept { return check_.totals(); }
    std::uint64_t missing_at_end() const noexcept { return missing_at_end_; }
    std::uint64_t malformed() const noexcept { return malformed_; }
    /// Returns the provenance of the samples, as meta has it.
    const Json& provenance() const noexcept { return provenance_; }
    /// Takes the changes of the scene since the last call, as meta has them; those before the first frame are in provenance().
    std::vector<Json> take_changes() { return std::exchange(changes_, {}); }
    /// Reason of the last failed handshake; empty: none failed.
    const std::string& refusal() const noexcept { return refusal_; }
    /// Names of the streams that the run has, once it is known.
    const std::vector<std::string>& streams() const noexcept { return streams_; }

    /// The frames' run, rate and channels, and the first one's sample; "" and 0 before the first one.
    const std::string& run() const noexcept { return run_; }
    double fs() const noexcept { return fs_; }
    std::size_t channels() const noexcept { return channels_; }
    std::uint64_t first_sample() const noexcept { return first_sample_; }

    /// Counts of frames received, missing or odd, by the names of docs/measures.md.
    Json account() const;
    /// The counts as one line.
    std::string text() const;

private:
    ReceivedFrame* take_frame(const Message& message);
    void take_meta(const Message& message);
    void take_end(const Message& message);
    void note_changes(const Json& meta);
    /// Whether the frame is of this run; reports why not.
    bool belongs_to_run(const FrameHeader& header);
    void begin(const FrameHeader& header);
    /// The first fault of the frame's channels and samples.
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
    std::optional<std::size_t> announced_channels_;  // by meta
    std::map<Arrival, int> notices_;                 // counted for each kind

    std::string run_;
    double fs_ = 0;
    std::size_t channels_ = 0;
    std::uint64_t first_sample_ = 0;
    std::uint64_t next_sample_ = 0;

    std::uint64_t missing_at_end_ = 0;
    std::uint64_t malformed_ = 0;
    std::string refusal_;  // the last one
    std::set<std::string> told_refusals_;
    ReceivedFrame frame_;
};

}  // namespace hertzline::stream
