#pragma once
// The samples that hertzline listen receives, saved to files.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "recordings/recording_set.hpp"

#include "apps/console/output.hpp"
#include "stream/listening/run_receiver.hpp"

namespace hertzline::app {

/// Where samples are saved.
struct RecordingRequest {
    std::vector<std::string> files;
    double full_scale = 1;  ///< of WAV files
};

/// Saves one run, and sums it up.
class ListenSession {
public:
    /// @param run the receiver of the frames @param wanted_s simulated seconds; unset: all of the run
    ListenSession(stream::RunReceiver& run, std::optional<double> wanted_s, RecordingRequest request,
                  stream::RunReceiver::Notify notify);

    /// Takes the next frame, and ends the run when it has lasted long enough.
    /// @throws std::runtime_error when the first samples come and a recording cannot be begun
    void take(const stream::ReceivedFrame& frame);

    /// Completes the recordings.
    void save();

    /// No recording has failed.
    bool saved() const noexcept { return !recordings_ || recordings_->complete(); }

    double simulated_s() const noexcept {
        return run_.has_samples() ? static_cast<double>(samples_) / run_.fs() : 0;
    }

    Json summary() const;

private:
    void begin();

    stream::RunReceiver& run_;
    std::optional<double> wanted_s_;
    RecordingRequest request_;
    stream::RunReceiver::Notify notify_;
    std::optional<recordings::RecordingSet> recordings_;  // from the first frame on
    std::uint64_t samples_ = 0;                           // kept
};

}  // namespace hertzline::app
