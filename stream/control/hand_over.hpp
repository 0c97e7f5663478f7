#pragma once
// Passes the next simulation of a stream to the simulating thread, and the one before it back, without a lock.
//
//     preparing thread                        simulating thread
//     while (!hand_over.idle()) ...           if (NextSimulation* next = hand_over.accept(...))
//     hand_over.offer(next)       ──────>         next->simulation will follow from that sample on
//     applies_at()                <──────     hand_over.applies(sample)
//     free the old one            <──────     hand_over.give_back(old)
//
// One is on its way at a time. A present simulation that gives no block is stopped from outside; then the next one takes over at once
// (give_up). Orders: a pointer is stored with release and taken with acquire, so the taker sees the
// object; the sample is stored with release, so its reader may rely on the pointer having been taken.

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <utility>

#include "core/model/drive.hpp"
#include "hertzline/simulation.hpp"

namespace hertzline::stream {

/// A simulation that is to follow the present one.
struct NextSimulation {
    NextSimulation(const Scene& scene, SimulationOptions options, bool motion_goes_on)
        : simulation(scene, watching(std::move(options), stop)),
          burst_end_s(first_burst_end_s(scene)),
          goes_on(motion_goes_on) {}

    std::atomic<bool> stop{false};  ///< ends its samples within a few steps
    Simulation simulation;
    double burst_end_s;  ///< in each period of the bursts; a record's is not looked up while samples are due
    bool goes_on;        ///< it continues the motion of the one before

private:
    static SimulationOptions watching(SimulationOptions options, const std::atomic<bool>& stop) noexcept {
        options.stop = &stop;
        return options;
    }
};

class HandOver {
public:
    /// @param first the simulation that runs now
    explicit HandOver(NextSimulation& first) noexcept : now_(&first) {}
    ~HandOver();
    HandOver(const HandOver&) = delete;
    HandOver& operator=(const HandOver&) = delete;

    // For the thread that controls.

    /// Whether the last offered simulation has taken over; frees the one that it replaced.
    bool idle() noexcept;
    /// Only when idle.
    void offer(std::unique_ptr<NextSimulation> next) noexcept;
    /// Returns the sample from which the one offered last applies; below 0: not known yet.
    std::int64_t applies_at() const noexcept { return applies_at_.load(std::memory_order_acquire); }
    /// Stops the present simulation, so that the offered one takes over at once. Only when one is on its way.
    void give_up() noexcept;

    /// Stops all of them, for good; from any thread but the simulating one.
    void interrupt() noexcept;

    // For the simulating thread; they allocate and free nothing.

    /// Returns the offered simulation; null: none.
    NextSimulation* accept() noexcept;
    bool interrupted() const noexcept { return interrupted_.load(std::memory_order_acquire); }
    void applies(std::int64_t sample) noexcept { applies_at_.store(sample, std::memory_order_release); }
    void give_back(NextSimulation* old) noexcept { returned_.store(old, std::memory_order_release); }

private:
    std::atomic<NextSimulation*> offered_{nullptr};
    std::atomic<NextSimulation*> returned_{nullptr};
    std::atomic<std::int64_t> applies_at_{-1};
    std::atomic<bool> interrupted_{false};
    std::mutex mutex_;                  // of the two below; the simulating thread never takes it
    NextSimulation* now_;               // as far as the controlling thread knows
    NextSimulation* coming_ = nullptr;  // on its way
};

inline HandOver::~HandOver() {
    delete offered_.load(std::memory_order_acquire);
    delete returned_.load(std::memory_order_acquire);
}

inline bool HandOver::idle() noexcept {
    const std::unique_ptr<NextSimulation> old(returned_.exchange(nullptr, std::memory_order_acquire));
    const std::scoped_lock lock(mutex_);
    if (old) {
        now_ = std::exchange(coming_, nullptr);
    }
    return coming_ == nullptr;
}

inline void HandOver::offer(std::unique_ptr<NextSimulation> next) noexcept {
    applies_at_.store(-1, std::memory_order_relaxed);
    const std::scoped_lock lock(mutex_);
    coming_ = next.get();
    coming_->stop.store(interrupted(), std::memory_order_relaxed);
    offered_.store(next.release(), std::memory_order_release);
}

inline void HandOver::give_up() noexcept {
    const std::scoped_lock lock(mutex_);
    now_->stop.store(true, std::memory_order_relaxed);
}

inline void HandOver::interrupt() noexcept {
    const std::scoped_lock lock(mutex_);
    interrupted_.store(true, std::memory_order_release);
    now_->stop.store(true, std::memory_order_relaxed);
    if (coming_ != nullptr) {
        coming_->stop.store(true, std::memory_order_relaxed);
    }
}

inline NextSimulation* HandOver::accept() noexcept {
    return offered_.load(std::memory_order_relaxed) == nullptr
               ? nullptr
               : offered_.exchange(nullptr, std::memory_order_acquire);
}

}  // namespace hertzline::stream
