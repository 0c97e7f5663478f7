#pragma once
// Recordings of the same samples, side by side, each written by a thread of its own. One that fails (a full disk, a
// file that vanished) or is too slow is reported; the other recordings and their source continue.

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/scene/json.hpp"
#include "recordings/recording.hpp"

namespace hertzline::recordings {

class RecordingThread;
enum class RecordingEnd;

/// The time for which a set waits for its files.
struct RecordingPatience {
    /// The time for a recording that takes nothing while its queue is full; then its rows are left out.
    std::chrono::milliseconds wait{0};
    /// Once true, all recordings have 0.6 s to end.
    const std::atomic<bool>* stop = nullptr;

    /// Leaves rows out at once: the source never waits.
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
        std::int64_t samples = 0;  ///< in the file, known at the end; an upper bound for a stuck file
        std::int64_t missing = 0;  ///< left out because the file was too slow or stuck
        std::string failure{};  ///< empty: none; else with the name of the file that holds the saved samples
        std::string warning{};  ///< known at the end; empty: none
    };

    /// Begins all of them. @throws std::runtime_error that names the path and the reason when one cannot be.
    /// @param report takes a message when a recording fails or is too slow, in the thread that calls write()
    RecordingSet(std::span<const std::string> paths, const RecordingHead& head, RecordingPatience patience,
                 std::function<void(const std::string&)> report, Appearance appearance = Appearance::early);
    /// Keeps the written rows of recordings that have not ended.
    ~RecordingSet();
    RecordingSet(const RecordingSet&) = delete;
    RecordingSet& operator=(const RecordingSet&) = delete;

    /// Bytes of rows that may wait for their files.
    static double queue_bytes(double columns, double sample_rate_hz) noexcept;

    /// Appends rows as RecordingWriter does, but does not throw when a recording cannot be written.
    void write(std::int64_t first, std::vector<double> values);

    /// Records a change of the scene with the next row, as RecordingWriter does.
    void note_change(const Json& change);

    /// Completes all recordings that have not failed. Does not throw.
    void commit();

    /// Removes all recordings that have not failed.
    void discard();

    /// Whether no recording has failed or lost samples.
    bool complete() const noexcept;
    /// Whether a recording is still being written.
    bool any_left() const noexcept;
    /// Returns warnings about ended recordings, a sentence each.
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
    std::function<void(const std::string&)> report_;
};

/// An object for each recording: file, samples, missing_samples, status ("complete", or why it is not).
Json recordings_json(std::span<const RecordingSet::Status> recordings);

}  // namespace hertzline::recordings
