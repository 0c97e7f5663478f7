#pragma once
// "Record" of a scope: what it hears of a stream goes to a file, gaps are marked.

#include <atomic>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "recordings/recording_set.hpp"

#include "core/scene/json.hpp"
#include "core/taps.hpp"
#include "stream/listening/run_receiver.hpp"

namespace hertzline::scope {

/// For one thread.
class ScopeRecorder {
public:
    /// A recording ends by itself when it has so many samples: 100 s at 10 MHz.
    static constexpr std::int64_t most_samples = 1'000'000'000;

    /// @param folder where recordings go; unset: none may be made
    /// @param stop set: recordings wait no longer for their files
    ScopeRecorder(std::optional<std::filesystem::path> folder, const std::atomic<bool>& stop);
    ~ScopeRecorder();
    ScopeRecorder(const ScopeRecorder&) = delete;
    ScopeRecorder& operator=(const ScopeRecorder&) = delete;

    /// From the next frame on. @param ending as of a recording's name: "sigmf-meta"
    /// @returns what is wrong; empty: nothing
    std::string begin(Tap tap, const std::string& ending);
    void end();
    bool is_on() const noexcept { return tap_.has_value(); }
    std::optional<Tap> tap() const noexcept { return tap_; }

    /// @param meta the last one: it says what the scene has become until now
    void take(stream::RunReceiver& run, const stream::ReceivedFrame& frame, const Json& meta);

    /// file, samples, missing and what happened, for the pages.
    Json state() const;

private:
    std::optional<std::filesystem::path> folder_;
    const std::atomic<bool>& stop_;
    std::optional<Tap> tap_;
    std::string file_;
    std::string run_;
    std::string text_;
    std::int64_t samples_ = 0;
    std::uint64_t missing_ = 0;
    std::unique_ptr<recordings::RecordingSet> set_;
};

}  // namespace hertzline::scope
