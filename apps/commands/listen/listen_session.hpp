#pragma once
// What a listener receives, saved to files.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "recordings/recording_set.hpp"

#include "apps/console/output.hpp"
#include "core/taps.hpp"
#include "stream/listening/received_run.hpp"
#include "stream/wire/subscriber.hpp"

namespace hertzline::app {

using stream::EndReason;

/// Where a listener saves what it hears.
struct RecordingRequest {
    std::vector<std::string> files;
    double full_scale = 1;  ///< of WAV files
};

/// One run as a listener receives it, from its meta to its end.
class ListenSession {
public:
    using Notify = stream::ReceivedRun::Notify;

    /// @param wanted_s simulated seconds; unset: all of the run
    ListenSession(Tap tap, std::optional<double> wanted_s, RecordingRequest request, Notify notify);

    /// Takes the next message. Afterwards end_reason() says whether it was the last one.
    /// @throws std::runtime_error when the first samples come and a recording cannot be begun
    void take(const stream::Message& message);

    /// Takes a failed handshake: the end when there will be no other.
    void note_refusal(const stream::Refusal& refusal) { received_.note_refusal(refusal); }

    void end(EndReason reason) noexcept { received_.end(reason); }
    EndReason end_reason() const noexcept { return received_.end_reason(); }

    /// Completes the recordings.
    void save();

    /// No recording has failed.
    bool saved() const noexcept { return !recordings_ || recordings_->sound(); }

    /// Something was received, and nothing was missing, odd or cut short.
    bool sound() const noexcept { return received_.sound(); }

    /// The stream has said what it is.
    bool knows_the_run() const noexcept { return received_.knows_the_run(); }
    /// The topic of the frames that the session takes.
    std::string_view topic() const noexcept { return received_.topic(); }

    bool heard_samples() const noexcept { return received_.heard_samples(); }
    double simulated_s() const noexcept {
        return heard_samples() ? static_cast<double>(samples_) / received_.fs() : 0;
    }

    /// The totals as a line of text, and as an object.
    std::string text() const { return received_.text(); }
    Json summary() const;

private:
    void begin();
    void take_samples(const stream::ReceivedFrame& frame);

    stream::ReceivedRun received_;
    std::optional<double> wanted_s_;
    RecordingRequest request_;
    Notify notify_;
    std::optional<recordings::RecordingSet> recordings_;  // once the first frame has told what is in them
    std::uint64_t samples_ = 0;                           // kept
};

}  // namespace hertzline::app
