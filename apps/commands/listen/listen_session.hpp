#pragma once
// What a listener receives: checks that nothing is missing, saves the samples, knows when it is over. The
// messages come from outside and are not trusted.

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "apps/console/output.hpp"
#include "core/taps.hpp"
#include "stream/recordings/recording_set.hpp"
#include "stream/wire/continuity.hpp"
#include "stream/wire/subscriber.hpp"
#include "stream/wire/topics.hpp"

namespace hertzline::app {

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

/// Where a listener saves what it hears.
struct RecordingRequest {
    std::vector<std::string> files;
    double full_scale = 1;  ///< of WAV files
};

/// One run as a listener receives it, from its meta to its end.
class ListenSession {
public:
    /// Takes a message for the user, as things happen.
    using Notify = std::function<void(const std::string&)>;

    /// @param wanted_s simulated seconds; unset: all of the run
    ListenSession(Tap tap, std::optional<double> wanted_s, RecordingRequest request, Notify notify);

    /// Takes the next message. Afterwards end_reason() says whether it was the last one.
    /// @throws std::runtime_error when the first samples come and a recording cannot be begun
    void take(const stream::Message& message);

    /// Takes a failed handshake: the end when there will be no other.
    void note_refusal(const stream::Refusal& refusal);

    void end(EndReason reason) noexcept { end_reason_ = reason; }
    EndReason end_reason() const noexcept { return end_reason_; }

    /// Completes the recordings.
    void save();

    /// No recording has failed.
    bool saved() const noexcept { return !recordings_ || recordings_->sound(); }

    /// Something was received, and nothing was missing, odd or cut short.
    bool sound() const noexcept;

    /// The stream has said what it is.
    bool knows_the_run() const noexcept { return knows_the_run_; }
    /// The topic of the frames that the session takes.
    std::string_view topic() const noexcept { return stream::topics_of(tap_).np; }

    bool heard_samples() const noexcept { return check_.totals().frames > 0; }
    double simulated_s() const noexcept { return fs_ > 0 ? static_cast<double>(samples_) / fs_ : 0; }

    /// The totals as a line of text, and as an object.
    std::string text() const;
    Json summary() const;

private:
    void take_frame(const stream::Message& message);
    void take_meta(const stream::Message& message);
    void take_end(const stream::Message& message);
    /// The frame is of this run; else says why not.
    bool belongs_to_run(const stream::FrameHeader& header);
    void take_samples(const stream::FrameHeader& header);
    void begin(const stream::FrameHeader& header);
    /// What is wrong with the frame's channels and samples; unset: nothing.
    std::optional<std::string> samples_fault(const stream::FrameHeader& header,
                                             std::span<const std::byte> payload);
    void note_malformed(const std::string& reason);
    void note_arrival(stream::Arrival arrival, const std::string& text);

    Tap tap_;
    std::optional<double> wanted_s_;
    RecordingRequest request_;
    Notify notify_;
    stream::ContinuityCheck check_;
    std::optional<stream::RecordingSet> recordings_;  // once the first frame has told what is in them
    Json provenance_ = Json::object();                // as meta says
    EndReason end_reason_ = EndReason::none;
    bool knows_the_run_ = false;
    std::optional<std::size_t> announced_channels_;  // as meta says
    std::map<stream::Arrival, int> notices_;         // so often the user was told of it

    // of the run that is listened to
    std::string run_;
    double fs_ = 0;
    std::size_t channels_ = 0;
    std::uint64_t first_sample_ = 0;
    std::uint64_t next_sample_ = 0;

    std::uint64_t samples_ = 0;  // kept
    std::uint64_t missing_at_end_ = 0;
    std::uint64_t malformed_ = 0;
    std::string refusal_;        // the last one that the user was told
    std::vector<float> values_;  // of the frame
};

}  // namespace hertzline::app
