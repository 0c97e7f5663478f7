#pragma once
// The stream: a simulating thread and a sending thread, joined by the ring.
//
//     Simulation -> [ring of blocks] -> pacer -> frames -> publisher
//                                            \-> recorder
//
// The simulating thread works ahead until the ring is full, so a hiccup of it or of the system is not heard;
// the sending thread (the caller's) lets each block go when it is due. What nobody subscribes to or records
// is not computed.

#include <atomic>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/simulation.hpp"
#include "stream/frame.hpp"
#include "stream/pacer.hpp"
#include "stream/publisher.hpp"
#include "stream/recorder.hpp"
#include "stream/ring_buffer.hpp"
#include "stream/stream_plan.hpp"
#include "stream/taps.hpp"

namespace hertzline {

/// As the system's tools list it (top -H).
inline constexpr const char* simulating_thread_name = "simulating";

/// What travels through the ring.
struct Block {
    Samples samples;
    TapSet taps;                ///< what was computed
    std::uint64_t dropped = 0;  ///< frames of the run discarded before this one
    std::int64_t contact_events = 0;
    std::int64_t steps = 0;
    std::int64_t busy_ns = 0;  ///< the simulating thread's work up to and with this block
    double energy_residual = 0;
};

class Pipeline {
public:
    /// @param recorder nullptr: nothing is recorded. With one, blocks are never discarded; the stream falls
    /// behind instead.
    Pipeline(StreamPlan plan, Publisher& publisher, Recorder* recorder);

    /// Streams until done, or until `stop` becomes true (then it returns within a fraction of a second).
    /// `progress` is called about ten times a second from this thread. Publishes meta, meters and, last, end
    /// with the summary's JSON that `summary` makes. @throws std::runtime_error when the simulation fails.
    StreamMeters run(const std::atomic<bool>& stop, const std::function<void(const StreamMeters&)>& progress,
                     const std::function<std::string(const StreamMeters&)>& summary);

    const std::string& run_id() const noexcept { return run_id_; }

    /// How long a queue the publisher shall keep for a slow subscriber: half a second of the small streams,
    /// and at most half a GiB of the large ones.
    static PublisherOptions publisher_options(const Scene& scene) noexcept;

    /// Bytes of the ring and the simulation for a scene.
    static double memory_bytes(const Scene& scene, Pace pace = Pace::realtime()) noexcept;

private:
    // simulating thread
    void simulate() noexcept;
    bool wait_for_start() noexcept;
    Block* wait_for_slot(std::int64_t first, std::int64_t count) noexcept;
    Wish wish_for(TapSet taps) const noexcept;

    // sending thread
    void deliver(const std::atomic<bool>& stop);
    void release(const Block& block);
    void send_tap(const Block& block, Tap tap);
    void listen_for_subscriptions();
    void start_when_ready();
    void report();
    Nanoseconds hold_until_due(const Block& block, const std::atomic<bool>& stop);

    StreamPlan plan_;
    Publisher& publisher_;
    Recorder* recorder_;
    std::string run_id_;
    Simulation simulation_;  // the simulating thread's while it runs
    double last_residual_ = 0;
    Pacer pacer_;
    TapSet possible_;
    RingBuffer<Block> ring_;

    std::atomic<TapSet> wanted_{TapSet()};
    std::atomic<bool> meters_wanted_{false};
    std::atomic<bool> started_{false};
    std::atomic<bool> stopping_{false};
    std::atomic<bool> finished_{false};
    std::atomic<std::uint64_t> dropped_{0};

    StreamMeters meters_;
    Nanoseconds start_time_{0};
    Nanoseconds first_subscription_{0};
    Nanoseconds next_meters_{0};
    Nanoseconds next_meta_{0};
    std::function<void(const StreamMeters&)> progress_;
    std::vector<float> payload_;
    std::string header_;
    FrameHeader frame_;
};

}  // namespace hertzline
