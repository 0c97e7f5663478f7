#pragma once
// How the next simulation of a stream gets to the simulating thread, and the one before it back, without a lock.
//
//     preparing thread                        simulating thread
//     while (!hand_over.idle()) ...           if (NextSimulation* next = hand_over.accept(...))
//     hand_over.offer(next)       ──────>         next->simulation will follow from that sample on
//     applies_at()                <──────     hand_over.applies(sample)
//     free what comes back        <──────     hand_over.give_back(old)
//
// One is on its way at a time. Orders: a pointer is stored with release and taken with acquire, so whoever takes it sees what it
// points to; the sample is stored with release, so whoever sees it may rely on the pointer having been taken.

#include <atomic>
#include <cstdint>
#include <memory>

#include "core/simulation.hpp"

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

    // the preparing thread's

    /// The last one that was offered has taken over; what it replaced is freed.
    bool idle() noexcept;
    /// Only when idle.
    void offer(std::unique_ptr<NextSimulation> next) noexcept;
    /// From which sample on the one offered last applies; below 0: not known yet.
    std::int64_t applies_at() const noexcept { return applies_at_.load(std::memory_order_acquire); }

    // the simulating thread's; they allocate and free nothing

    /// What was offered; null: nothing.
    NextSimulation* accept() noexcept;
    void applies(std::int64_t sample) noexcept { applies_at_.store(sample, std::memory_order_release); }
    void give_back(NextSimulation* old) noexcept { returned_.store(old, std::memory_order_release); }

private:
    std::atomic<NextSimulation*> offered_{nullptr};
    std::atomic<NextSimulation*> returned_{nullptr};
    std::atomic<std::int64_t> applies_at_{-1};
    bool on_its_way_ = false;  // the preparing thread's
};

}  // namespace hertzline::stream
