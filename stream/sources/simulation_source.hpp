#pragma once
// A scene that is simulated while it is streamed.

#include <atomic>

#include "core/simulation.hpp"
#include "stream/sources/sample_source.hpp"

namespace hertzline::stream {

/// read(), skip() and whatever else the simulating thread calls allocate nothing and make no system call.
class SimulationSource : public SampleSource {
public:
    /// @param scene resolved (core/step_choice/resolve.hpp)
    /// @param always taps that are computed although nobody subscribes to them, if there is room for them
    SimulationSource(const Scene& scene, TapSet always);

    StreamFormat format() const override { return format_; }
    bool read(Samples& samples, std::size_t count, TapSet wanted) noexcept override;
    bool skip(std::int64_t count) noexcept override;
    void interrupt() noexcept override { stop_.store(true, std::memory_order_relaxed); }
    std::int64_t next_sample() const noexcept override { return simulation_.next_sample(); }
    SourceAccount account() const noexcept override;
    MotionExtent motion() noexcept override { return simulation_.extent(); }
    std::string failure() const override { return simulation_.failure(); }

    /// The format that a scene's stream has.
    static StreamFormat format_of(const Scene& scene) noexcept;

    /// Bytes that a source of this scene needs, roughly from above.
    static double memory_bytes(const Scene& scene) noexcept;

private:
    StreamFormat format_;
    TapSet always_;
    std::atomic<bool> stop_{false};
    Simulation simulation_;
};

}  // namespace hertzline::stream
