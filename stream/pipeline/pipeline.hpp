#pragma once
// The stream: a simulating thread and a sending thread, joined by the ring.
//
//     source -> [ring of blocks] -> pacer -> frames -> publisher
//                                        \-> recorder
//
// The simulating thread (producer.hpp) works ahead until the ring is full, so a hiccup of it or of the system delays
// no frame. The sending thread (the caller's) releases each block when it is due. Taps without subscriber or
// recording are not computed.

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "core/scene/json.hpp"
#include "recordings/columns.hpp"
#include "stream/inputs/sample_source.hpp"
#include "stream/pipeline/frame_sender.hpp"
#include "stream/pipeline/load_shedder.hpp"
#include "stream/pipeline/pacer.hpp"
#include "stream/pipeline/producer.hpp"
#include "stream/pipeline/stream_monitor.hpp"
#include "stream/pipeline/topic_demand.hpp"
#include "stream/threads.hpp"
#include "stream/wire/publisher.hpp"

namespace hertzline::stream {

/// A new random UUID, version 4 (RFC 9562), lower case, 36 characters. @throws std::runtime_error when the
/// machine has no source of randomness.
std::string make_run_id();

enum class StreamStart { at_once, with_first_subscriber };

/// The options of a stream.
struct StreamOptions {
    std::string run = make_run_id();  ///< the run's id
    Json about;                       ///< members of meta beside the format of samples (measures/provenance)
    Epoch epoch{};                    ///< the epoch of the first samples
    Pace pace = Pace::realtime();
    std::optional<std::int64_t> samples{};  ///< unset: to the end, or until stopped
    StreamStart start = StreamStart::at_once;
    OnOverrun on_overrun = OnOverrun::drop;
    ThreadOptions thread{};
};

/// Callbacks of the pipeline to its owner, in the sending thread.
struct StreamEvents {
    std::function<void(const StreamMeters&)> progress;  ///< about ten times a second
    std::function<void(const std::string&)> warn;       ///< takes a message for the user
    std::function<void()> starts = {};  ///< once, if set: no subscriber is waited for any more
    /// Before the first frame of another epoch, if set: members of meta that have changed.
    std::function<Json(const Epoch&)> epoch_begins = {};
    /// About ten times a second, if set: members of meta that have changed, or nothing.
    std::function<Json(const MotionExtremes&)> watch = {};
    std::function<std::string(const StreamMeters&)> summary;  ///< returns the message of the end topic
};

/// A source, a ring and a publisher, joined by two threads.
class Pipeline {
public:
    /// Source, publisher and recorder outlive the pipeline. @param recorder nullptr: nothing is recorded
    Pipeline(StreamOptions options, SampleSource& source, Publisher& publisher,
             recordings::RowBuilder* recorder);

    /// Streams until done, or until `stop` becomes true (then it returns within a fraction of a second).
    /// Publishes meta, meters and, last, end.
    /// @throws std::runtime_error when the simulation fails
    StreamMeters run(const std::atomic<bool>& stop, const StreamEvents& events);

    const StreamOptions& options() const noexcept { return options_; }
    const StreamFormat& format() const noexcept { return format_; }
    /// The time at which sample 0 was due, on MonotonicClock; before the start 0.
    Nanoseconds start_time() const noexcept { return start_time_.value_or(Nanoseconds{0}); }

private:
    void deliver(const std::atomic<bool>& stop);
    std::uint64_t passed_over();
    void start_when_ready(Nanoseconds now);
    Nanoseconds lateness_of_next(Nanoseconds now) const noexcept;
    std::uint64_t deadline_of(std::int64_t end, std::size_t blocks) const noexcept;
    Nanoseconds hold_until_due(const Block& block, const std::atomic<bool>& stop);
    void enter(const Epoch& epoch);
    void release(const Block& block);
    void judge_load(const Block& block, Nanoseconds lateness);
    void listen_for_subscriptions();
    void report(Nanoseconds now);
    void watch();
    void send_meta();

    StreamOptions options_;
    SampleSource& source_;
    Publisher& publisher_;
    recordings::RowBuilder* recorder_;
    StreamFormat format_;
    Pacer pacer_;
    Producer producer_;
    TopicDemand demand_;
    LoadShedder shedder_;
    FrameSender frames_;
    StreamMonitor monitor_;
    const StreamEvents* events_ = nullptr;  // those of run()

    std::optional<Nanoseconds> start_time_;
    std::optional<Nanoseconds> first_subscription_;
    Nanoseconds listened_{0};  // for subscriptions
    bool warned_of_too_many_clients_ = false;
    bool warned_of_shedding_ = false;
    Nanoseconds next_meters_{0};
    Nanoseconds next_meta_{0};
};

}  // namespace hertzline::stream
