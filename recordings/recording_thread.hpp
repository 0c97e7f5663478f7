#pragma once
// A recording that is written by a thread of its own, so that a slow or stuck file delays nothing else.

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "recordings/recording.hpp"

namespace hertzline::recordings {

/// Rows that several recordings share.
using SharedRows = std::shared_ptr<const RecordedRows>;

/// The end of a recording.
enum class RecordingEnd { commit, keep, discard };

/// The outcome of a recording.
struct RecordingResult {
    std::string failure;                 ///< empty: none
    std::string warning;                 ///< the writer's; empty: none
    KeptRows kept;                       ///< the rows that it left
    std::int64_t unwritten_numbers = 0;  ///< in the queue when it ended, and lost
};

/// A writer, the thread that calls it, and a bounded queue of rows between.
class RecordingThread {
public:
    using Duration = std::chrono::steady_clock::duration;

    /// @param max_bytes of the rows that may wait
    RecordingThread(std::unique_ptr<RecordingWriter> writer, std::size_t max_bytes);
    /// Leaves a thread behind that still waits for its file: see any_abandoned().
    ~RecordingThread();
    RecordingThread(const RecordingThread&) = delete;
    RecordingThread& operator=(const RecordingThread&) = delete;

    /// Returns false when the queue is full or the recording over. A change always fits.
    bool try_write(const SharedRows& rows);
    /// Waits up to the time for more rows to be written. Returns false when none were, or the recording is over.
    bool wait_for_progress(Duration most);

    /// Ends the recording when its queue is empty.
    void end(RecordingEnd how);
    /// Ends it without the rows that still wait.
    void hurry();
    /// Waits for the end. Returns false when it has not come in time.
    bool wait_for_end(Duration most);

    bool over() const;
    /// Whether the writer has failed; it is over soon.
    bool failed() const;
    /// Returns the outcome, once it is over.
    RecordingResult result() const;
    /// Numbers that the writer has taken so far.
    std::int64_t numbers() const;
    /// Numbers that it has not taken yet.
    std::int64_t waiting_numbers() const;

    /// Whether a thread was left waiting for its file, so that the program must end by std::_Exit.
    static bool any_abandoned() noexcept;

private:
    /// State shared by the thread and its owner; lives as long as either.
    struct Shared {
        std::int64_t waiting_numbers() const;  // under the mutex

        std::unique_ptr<RecordingWriter> writer;
        std::size_t max_bytes = 0;

        std::mutex mutex;              // guards all members below
        std::condition_variable news;  // wakes the thread
        std::condition_variable done;  // wakes the owner
        std::deque<SharedRows> queue;  // the first is being written
        std::size_t bytes = 0;         // in the queue
        std::optional<RecordingEnd> ending;
        bool full = false;
        bool hurry = false;
        bool over = false;
        std::int64_t numbers = 0;  // written
        RecordingResult result;
    };

    static void work(Shared& shared);
    static void write_queue(Shared& shared, std::unique_lock<std::mutex>& lock);

    std::shared_ptr<Shared> shared_;
    std::thread thread_;
};

}  // namespace hertzline::recordings
