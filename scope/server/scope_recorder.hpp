#pragma once
// Recordings of a scope: received samples go to a file, with gaps marked.

#include <atomic>
#include <filesystem>
#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/scene/json.hpp"
#include "hertzline/taps.hpp"
#include "recordings/recording_set.hpp"
#include "stream/listening/run_receiver.hpp"

namespace hertzline::scope {

/// For one thread.
class ScopeRecorder {
public:
    /// A recording ends by itself when it has so many samples, 100 s at 10 MHz, and when it cannot be written.
    static constexpr std::int64_t most_samples = 1'000'000'000;

    /// @param folder where recordings go
    /// @param stop set: recordings wait no longer for their files
    /// @param report takes a message when a recording fails or is too slow, in any thread
    ScopeRecorder(std::filesystem::path folder, const std::atomic<bool>& stop,
                  std::function<void(const std::string&)> report);
    ~ScopeRecorder();
    ScopeRecorder(const ScopeRecorder&) = delete;
    ScopeRecorder& operator=(const ScopeRecorder&) = delete;

    /// Records from the next frame on. @param ending of a recording's name: "sigmf-meta"
    /// @returns the fault, if there is one
    std::optional<std::string> begin(Tap tap, const std::string& ending);
    /// Lets another thread save the recording: a slow disk holds nothing up.
    void end();
    /// Looks whether it is saved, and ends that of a stream that has ended.
    void advance(bool stream_has_ended);
    /// Ends a recording that is on, and waits until it is saved.
    void finish();
    /// Also while it is being saved.
    bool is_on() const noexcept { return tap_.has_value() || is_being_saved_; }
    std::optional<Tap> tap() const noexcept { return tap_; }

    /// @param meta the last one, with the changes of the scene so far
    void take(stream::RunReceiver& run, const stream::ReceivedFrame& frame, const Json& meta);

    /// Returns file, counts of samples and of missing ones, and a text, for the pages.
    Json state() const;
    /// Returns those that are over, in their order.
    const std::vector<recordings::RecordingSet::Status>& finished() const noexcept { return finished_; }

private:
    void take_result();

    std::filesystem::path folder_;
    const std::atomic<bool>& stop_;
    std::function<void(const std::string&)> report_;
    std::vector<recordings::RecordingSet::Status> finished_;
    std::optional<Tap> tap_;
    std::string file_;
    std::string run_;
    std::string text_;
    std::int64_t samples_ = 0;
    std::int64_t known_epoch_ = 0;  // of the latest change that the recording has
    std::uint64_t missing_ = 0;
    std::unique_ptr<recordings::RecordingSet> set_;
    std::atomic<bool> is_being_saved_{false};
    std::future<recordings::RecordingSet::Status> saved_;  // last: its thread uses the others
};

}  // namespace hertzline::scope
