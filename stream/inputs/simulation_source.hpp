#pragma once
// A scene that is simulated while it is streamed, and may change on the way.

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>

#include "hertzline/simulation.hpp"
#include "stream/control/hand_over.hpp"
#include "stream/inputs/sample_source.hpp"

namespace hertzline::stream {

class LiveDrive;

/// read(), skip() and whatever else the simulating thread calls allocate nothing and make no system call.
class SimulationSource : public SampleSource {
public:
    /// @param scene resolved (hertzline/resolve.hpp)
    /// @param always taps that are computed without subscribers, too, if there is room for them
    /// @param live outlives the source; null: there is no live drive
    SimulationSource(const Scene& scene, TapSet always, LiveDrive* live = nullptr);

    StreamFormat format() const override { return format_; }
    bool wait_for(std::int64_t count) noexcept override;
    bool read(Samples& samples, std::size_t count, TapSet wanted) noexcept override;
    bool skip(std::int64_t count) noexcept override;
    void interrupt() noexcept override;
    void end() noexcept override;
    std::int64_t samples_to_change() noexcept override;
    Epoch epoch() const noexcept override { return epoch_; }
    std::int64_t next_sample() const noexcept override { return now().next_sample(); }
    SourceAccount account() noexcept override;
    MotionExtremes motion() noexcept override { return current_->simulation.extremes(); }
    std::string failure() const override;
    std::optional<DriveCounts> drive() const noexcept override;
    std::vector<std::string> take_warnings() override;

    /// Takes simulations of scenes that shall follow. They are made with options(); their stream has the same format but
    /// for the repetition of bursts.
    HandOver& hand_over() noexcept { return hand_over_; }
    SimulationOptions options() const noexcept;

    /// Returns a number that is odd while a block is being computed, and another one for each block; from any thread.
    std::uint64_t progress() const noexcept { return progress_.load(std::memory_order_relaxed); }

    /// The sample at which a change takes effect that becomes known now: the next burst's start if that is no more than a second away;
    /// else the end of the burst that plays, on the same condition; else at once. At once also where bursts do not repeat.
    /// @param burst_end_s when a burst is over, since its period's start @param from the first sample that it can be
    static std::int64_t change_at(const Epoch& epoch, double burst_end_s, double sample_rate_hz,
                                  std::int64_t from) noexcept;

    /// The fault of a scene with more points than a stream has time for.
    static std::optional<Fault> fault_of(const Scene& scene);

    /// The format that a scene's stream has.
    static StreamFormat format_of(const Scene& scene) noexcept;

    /// Bytes that a source of this scene needs, roughly from above. @throws std::bad_alloc
    static double memory_bytes(const Scene& scene);

private:
    const Simulation& now() const noexcept { return current_->simulation; }
    template <class Work>
    bool proceed(const Work& work) noexcept;
    void take_up() noexcept;
    bool take_up_at_once(std::int64_t sample) noexcept;
    void change() noexcept;

    LiveDrive* live_;
    StreamFormat format_;
    TapSet always_;
    std::unique_ptr<NextSimulation> current_;
    HandOver hand_over_;
    std::atomic<std::uint64_t> progress_{0};
    std::unique_ptr<NextSimulation> next_;
    std::int64_t change_at_ = 0;  // of the next one
    bool gave_up_ = false;        // the present one was stopped for the next one
    Epoch epoch_;
    SourceAccount before_;  // the present simulation
};

}  // namespace hertzline::stream
