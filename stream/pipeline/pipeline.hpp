#pragma once
// The stream: a simulating thread and a sending thread, joined by the ring.
//
//     source -> [ring of blocks] -> pacer -> frames -> publisher
//                                        \-> recorder
//
// The simulating thread (producer.hpp) works ahead until the ring is full, so a hiccup of it or of the system
// is not heard; the sending thread (the caller's) lets each block go when it is due. What nobody subscribes
// to or records is not computed.

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/taps.hpp"
#include "stream/pipeline/pacer.hpp"
#include "stream/pipeline/producer.hpp"
#include "stream/pipeline/stream_options.hpp"
#include "stream/recordings/row_builder.hpp"
#include "stream/sources/sample_source.hpp"
#include "stream/wire/frame.hpp"
#include "stream/wire/publisher.hpp"

namespace hertzline::stream {

/// What the pipeline tells its owner, in the sending thread.
struct StreamEvents {
    std::function<void(const StreamMeters&)> progress;        ///< about ten times a second
    std::function<void(const std::string&)> warn;             ///< for the user
    std::function<std::string(const StreamMeters&)> summary;  ///< at the end: what the end topic shall say
};

/// A source, a ring and a publisher, joined by two threads.
class Pipeline {
public:
    /// @param recorder nullptr: nothing is recorded
    Pipeline(StreamOptions plan, SampleSource& source, Publisher& publisher, RowBuilder* recorder);

    /// Streams until done, or until `stop` becomes true (then it returns within a fraction of a second).
    /// Publishes meta, meters and, last, end. @throws std::runtime_error when the simulation fails.
    StreamMeters run(const std::atomic<bool>& stop, const StreamEvents& events);

    const std::string& run_id() const noexcept { return run_id_; }
    const StreamOptions& plan() const noexcept { return plan_; }
    const StreamFormat& format() const noexcept { return format_; }
    /// When sample 0 was due, in the time of MonotonicClock; before the start 0.
    Nanoseconds start_time() const noexcept { return start_time_; }

    /// How long a queue the publisher shall keep for a slow subscriber: half a second of the small streams,
    /// and at most half a GiB of the large ones.
    static PublisherOptions publisher_options(const StreamFormat& format) noexcept;

    /// Bytes of the ring.
    static double ring_bytes(const StreamFormat& format, Pace pace = Pace::realtime()) noexcept;

private:
    void deliver(const std::atomic<bool>& stop);
    void release(const Block& block);
    void count(const Block& block, Nanoseconds lateness);
    void send_tap(const Block& block, Tap tap);
    void count_dropped(std::uint64_t dropped);
    void listen_for_subscriptions();
    void start_when_ready(Nanoseconds now);
    void report(Nanoseconds now);
    void look_at_ring();
    void measure(Nanoseconds now);
    Nanoseconds hold_until_due(const Block& block, const std::atomic<bool>& stop);

    StreamOptions plan_;
    SampleSource& source_;
    Publisher& publisher_;
    RowBuilder* recorder_;
    StreamFormat format_;
    std::string run_id_;
    Pacer pacer_;
    Producer producer_;
    const StreamEvents* events_ = nullptr;

    bool started_ = false;
    TapSet wanted_raw_;
    TapSet wanted_np_;
    TapSet wanted_;
    std::array<std::uint32_t, all_taps.size()> wanted_since_{};  // number of the wish that began it
    StreamMeters meters_;
    std::uint64_t dropped_counted_ = 0;
    Nanoseconds start_time_{0};
    Nanoseconds first_subscription_{0};
    Nanoseconds next_meters_{0};
    Nanoseconds next_meta_{0};
    Nanoseconds measured_at_{0};
    Nanoseconds busy_then_{0};
    std::vector<float> payload_;
    std::string header_;
    FrameHeader frame_;
};

}  // namespace hertzline::stream
