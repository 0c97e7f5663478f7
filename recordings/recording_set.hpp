#pragma once
// Recordings of the same samples, side by side, each written by a thread of its own. One that fails (a full disk, a
// file that vanished) or is too slow is reported; the others go on, and so does whoever feeds them.

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "recordings/recording.hpp"

#include "core/scene/json.hpp"

namespace hertzline::recordings {

class RecordingThread;
enum class RecordingEnd;

/// How long a set waits for its files.
struct RecordingPatience {
    /// For one that takes nothing while its queue is full; then rows are left out of it.
    std::chrono::milliseconds wait{0};
    /// Once true, half a second for all at the end.
    const std::atomic<bool>* stop = nullptr;

    /// Rows are left out at once: the source waits for nobody.
    static RecordingPatience none(const std::atomic<bool>& stop) { return {{}, &stop}; }
    /// The source goes as fast as its files, unless one is stuck.
    static RecordingPatience of_a_second(const std::atomic<bool>& stop) {
        return {std::chrono::seconds(1), &stop};
    }
    /// Nothing is ever left out.
    static RecordingPatience endless(const std::atomic<bool>& stop) {
        return {std::chrono::milliseconds::max(), &stop};
    }
};

/// The recordings that are written of the same samples. For one thread.
class RecordingSet {
public:
    struct Status {
        std::string file;
        std::int64_t samples = 0;  ///< that are in the file, known at the end; at most, where it is stuck
        std::int64_t missing = 0;  ///< left out because the file was too slow or stuck
        std::string failure;       ///< empty: none; else with the name of the file that holds what was saved
        std::string warning;       ///< known at the end; empty: none
    };

    /// Begins all of them. @throws std::runtime_error that names the path and the reason when one cannot be.
    /// @param tell takes a message when a recording fails or is too slow, in the thread that calls write()
    RecordingSet(std::span<const std::string> paths, const RecordingHead& head, RecordingPatience patience,
                 std::function<void(const std::string&)> tell, Appearance appearance = Appearance::early);
    /// Keeps what was written of those that have not ended.
    ~RecordingSet();
    RecordingSet(const RecordingSet&) = delete;
    RecordingSet& operator=(const RecordingSet&) = delete;

    /// Bytes of rows that may wait for their files.
    static double queue_bytes(double columns, double sample_rate_hz) noexcept;

    /// Appends rows as RecordingWriter does, but does not throw when a recording cannot be written.
    void write(std::int64_t first, std::vector<double> values);

    /// The scene changes with the row that follows, as RecordingWriter has it.
    void note_change(const Json& change);

    /// Completes those that have not failed. Does not throw either.
    void commit();

    /// Removes those that have not failed.
    void discard();

    /// None has failed or lost samples.
    bool sound() const noexcept;
    /// Some is still being written.
    bool any_left() const noexcept;
    /// What the user should know of recordings that are over, a sentence each.
    std::vector<std::string> warnings() const;
    /// In the order of the paths.
    const std::vector<Status>& status() const noexcept { return status_; }

private:
    using Clock = std::chrono::steady_clock;

    bool stop_asked() const noexcept { return patience_.stop != nullptr && *patience_.stop; }
    bool pass_on(RecordingThread& thread, const std::shared_ptr<const RecordedRows>& rows, bool behind) const;
    bool wait_for_progress(RecordingThread& thread) const;
    void end(RecordingEnd how);
    void wait_while_they_write() const;
    bool all_over_by(Clock::time_point time) const;
    void conclude(std::size_t recording);

    std::vector<Status> status_;
    std::vector<std::unique_ptr<RecordingThread>> threads_;  // one for each; nullptr: it is over
    std::vector<char> behind_;                               // rows are being left out
    std::size_t columns_;
    RecordingPatience patience_;
    std::function<void(const std::string&)> tell_;
};

/// An object for each recording: file, samples, missing_samples, status ("complete", or why it is not).
Json recordings_json(const RecordingSet& recordings);

}  // namespace hertzline::recordings
