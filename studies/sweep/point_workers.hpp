#pragma once
// Threads that run points: where these come from and where their rows go is another's concern.

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <mutex>
#include <optional>
#include <span>
#include <thread>
#include <vector>

#include "studies/sweep/sweep.hpp"

namespace hertzline::studies {

/// Where workers get points and leave rows. Its functions are called by all of them at once; what they throw ends the workers.
class PointExchange {
public:
    virtual ~PointExchange() = default;
    PointExchange() = default;
    PointExchange(const PointExchange&) = delete;
    PointExchange& operator=(const PointExchange&) = delete;

    /// The next point, waiting for it; nothing when there will be none.
    virtual std::optional<std::int64_t> take() = 0;
    /// @param payload as encode() has it
    virtual void put(std::int64_t point, PointStatus status, std::span<const std::byte> payload) = 0;
};

/// Threads at work, each with a runner of its own, until there are no more points. Who destroys them early sets `stop` before, and sees to
/// it that take() ends.
class PointWorkers {
public:
    /// @param stop ends each point within a few steps; all three outlive this @throws std::system_error when no thread can be started
    PointWorkers(const Sweep& sweep, PointExchange& exchange, std::size_t threads,
                 const std::atomic<bool>& stop);

    /// Waits for all threads to end, or so long. @returns whether they have
    bool wait_for(std::chrono::milliseconds time);

    /// Ends the work at the next points, because of a failure.
    void give_up(std::exception_ptr failure) noexcept;

    /// Whether a thread has failed, or give_up() was called.
    bool failed() const noexcept { return failed_.load(std::memory_order_relaxed); }

    /// Waits for the threads. @throws what the first of them has failed with, or give_up() was given
    void finish();

private:
    void work() noexcept;
    void run_points();

    const Sweep& sweep_;
    PointExchange& exchange_;
    const std::atomic<bool>& stop_;
    std::atomic<bool> failed_{false};
    std::mutex mutex_;  // of what follows
    std::condition_variable changed_;
    std::size_t ended_ = 0;
    std::exception_ptr failure_;
    std::vector<std::jthread> threads_;  // last: they use all before
};

}  // namespace hertzline::studies
