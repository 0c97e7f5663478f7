#pragma once
// Recordings of the same samples, side by side. One that fails (a full disk, a file that vanished) is reported
// and is over; the others go on, and so does whoever feeds them.

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "stream/recordings/recording.hpp"

namespace hertzline::stream {

/// The recordings that are written of the same samples.
class RecordingSet {
public:
    struct Status {
        std::string file;
        std::int64_t samples = 0;  ///< taken so far; once it has failed: that were saved
        std::string failure;       ///< empty: none; else with the name of the file that holds what was saved
    };

    /// Begins all of them. @throws std::runtime_error that names the path and the reason when one cannot be.
    /// @param tell takes a message when a recording fails later on
    RecordingSet(std::span<const std::string> paths, const RecordingHead& head,
                 std::function<void(const std::string&)> tell);
    /// Keeps what was written of those that have not failed.
    ~RecordingSet();
    RecordingSet(const RecordingSet&) = delete;
    RecordingSet& operator=(const RecordingSet&) = delete;

    /// Appends rows as RecordingWriter does, but does not throw when a recording cannot be written.
    void write(std::int64_t first, std::span<const double> values);

    /// Completes those that have not failed. Does not throw either.
    void commit();

    /// Removes those that have not failed.
    void discard() noexcept;

    /// None has failed.
    bool sound() const noexcept;
    /// Some is still being written.
    bool any_left() const noexcept;
    /// In the order of the paths.
    const std::vector<Status>& status() const noexcept { return status_; }

private:
    template <class Action>
    void each(Action action);
    void end(std::size_t recording, const std::string& reason);

    std::vector<Status> status_;
    std::vector<std::unique_ptr<RecordingWriter>> writers_;  // one for each; nullptr: it is over
    std::size_t columns_;
    std::function<void(const std::string&)> notify_;
};

/// An object for each recording: file, samples, status ("complete", or why it is not).
nlohmann::ordered_json recordings_json(const RecordingSet& recordings);

}  // namespace hertzline::stream
