#pragma once
// Passes the next simulation of a stream to the simulating thread, and the one before it back, without a lock.
//
//     preparing thread                        simulating thread
//     while (!hand_over.idle()) ...           if (NextSimulation* next = hand_over.accept(...))
//     hand_over.offer(next)       ──────>         next->simulation will follow from that sample on
//     applies_at()                <──────     hand_over.applies(sample)
//     free the old one            <──────     hand_over.give_back(old)
//
// One is on its way at a time. Orders: a pointer is stored with release and taken with acquire, so the taker sees the
// object; the sample is stored with release, so its reader may rely on the pointer having been taken.

#include <atomic>
#include <cstdint>
#include <memory>

#include "hertzline/simulation.hpp"

namespace hertzline::stream {

/// A simulation that is to follow the present one.
struct NextSimulation {
    NextSimulation(const Scene& scene, const SimulationOptions& options, bool motion_goes_on)
        : simulation(scene, options), goes_on(motion_goes_on) {}

    Simulation simulation;
    bool goes_on;  ///< it continues the motion of the one before
};

class HandOver {
public:
    HandOver() = default;
    ~HandOver();
    HandOver(const HandOver&) = delete;
    HandOver& operator=(const HandOver&) = delete;

    // For the preparing thread.

    /// Whether the last offered simulation has taken over; frees the one that it replaced.
    bool idle() noexcept;
    /// Only when idle.
    void offer(std::unique_ptr<NextSimulation> next) noexcept;
    /// Returns the sample from which the one offered last applies; below 0: not known yet.
    std::int64_t applies_at() const noexcept { return applies_at_.load(std::memory_order_acquire); }

    // For the simulating thread; they allocate and free nothing.

    /// Returns the offered simulation; null: none.
    NextSimulation* accept() noexcept;
    void applies(std::int64_t sample) noexcept { applies_at_.store(sample, std::memory_order_release); }
    void give_back(NextSimulation* old) noexcept { returned_.store(old, std::memory_order_release); }

private:
    std::atomic<NextSimulation*> offered_{nullptr};
    std::atomic<NextSimulation*> returned_{nullptr};
    std::atomic<std::int64_t> applies_at_{-1};
    bool on_its_way_ = false;  // the preparing thread's
};

inline HandOver::~HandOver() {
    delete offered_.load(std::memory_order_acquire);
    delete returned_.load(std::memory_order_acquire);
}

inline bool HandOver::idle() noexcept {
    if (!on_its_way_) {
        return true;
    }
    const std::unique_ptr<NextSimulation> old(returned_.exchange(nullptr, std::memory_order_acquire));
    on_its_way_ = old == nullptr;
    return !on_its_way_;
}

inline void HandOver::offer(std::unique_ptr<NextSimulation> next) noexcept {
    on_its_way_ = true;
    applies_at_.store(-1, std::memory_order_relaxed);
    offered_.store(next.release(), std::memory_order_release);
}

inline NextSimulation* HandOver::accept() noexcept {
    return offered_.load(std::memory_order_relaxed) == nullptr
               ? nullptr
               : offered_.exchange(nullptr, std::memory_order_acquire);
}

}  // namespace hertzline::stream
