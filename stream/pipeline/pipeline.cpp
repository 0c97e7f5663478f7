#include "stream/pipeline/pipeline.hpp"

#include <algorithm>
#include <array>
#include <random>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "core/scene/json.hpp"
#include "stream/pipeline/capacity.hpp"
#include "stream/pipeline/stream_messages.hpp"
#include "stream/wire/topics.hpp"

namespace hertzline::stream {

namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

constexpr Nanoseconds meters_period = milliseconds(100);
constexpr Nanoseconds meta_period = milliseconds(1000);
/// Subscribers that come together shall all get sample 0.
constexpr Nanoseconds gathering = milliseconds(200);
/// The ring is empty when the simulation begins. Sample 0 is due when it had time to fill it.
constexpr Nanoseconds head_start = milliseconds(20);
/// Looking for subscriptions takes four system calls, a block every 0.1 ms.
constexpr Nanoseconds subscriptions_period = microseconds(200);
/// While there are no blocks, subscriptions and the stop flag are looked at this often.
constexpr Nanoseconds idle_period = milliseconds(1);
/// A stream that waits for its first subscriber is woken by it, and looks at the stop flag this often.
constexpr milliseconds waiting_period{50};

}  // namespace

Pipeline::Pipeline(StreamOptions options, SampleSource& source, Publisher& publisher,
                   recordings::RowBuilder* recorder)
    : options_(std::move(options)),
      source_(source),
      publisher_(publisher),
      recorder_(recorder),
      format_(source.format()),
      pacer_(format_.sample_rate_hz, options_.pace),
      producer_(source, pacer_, ring_size(format_, options_.pace), options_.samples,
                options_.pace.is_flat_out() ? OnOverrun::wait : options_.on_overrun),
      demand_(format_.taps, recorder != nullptr ? recorder->taps() : TapSet()),
      shedder_(format_),
      frames_(publisher, format_, options_.run),
      monitor_(producer_.origin(), format_.sample_rate_hz) {
    options_.about["security"] = word(publisher.security());
    demand_.update(publisher, producer_, {});  // the first block has the recorded taps, too
}

StreamMeters Pipeline::run(const std::atomic<bool>& stop, const StreamEvents& events) {
    events_ = &events;
    const PunctualWaking on_time;
    send_meta();
    for (const std::string& refused : producer_.start(options_.thread)) {
        events.warn(refused);
    }
    const ShortSlices prompt;  // not for the simulating thread, which has begun
    deliver(stop);
    producer_.stop();
    source_.end();
    // No later header counts the blocks that were discarded last: the end does.
    monitor_.count_dropped(producer_.dropped() + passed_over(), demand_);
    monitor_.pass(producer_.discarded_to());
    if (start_time_) {
        monitor_.measure_all(MonotonicClock::now(), *start_time_, producer_.busy());
    }
    monitor_.meters().drive = source_.drive();
    for (const std::string& text : source_.take_warnings()) {
        events.warn(text);
    }
    if (source_.epoch().number == options_.epoch.number) {  // else it is beyond the sent samples
        monitor_.meters().motion = source_.motion();
    }
    if (!source_.failure().empty()) {
        throw std::runtime_error(source_.failure());
    }
    publisher_.send_last(end_topic, events.summary(monitor_.meters()));
    return monitor_.meters();
}

void Pipeline::deliver(const std::atomic<bool>& stop) {
    while (!stop.load(std::memory_order_relaxed)) {
        const Nanoseconds now = MonotonicClock::now();
        start_when_ready(now);
        report(now);
        const bool finished = producer_.finished();
        const Block* block = producer_.front();
        if (block == nullptr) {
            if (finished) {
                return;
            }
            monitor_.wait(lateness_of_next(now));
            listen_for_subscriptions();
            if (start_time_) {
                producer_.wait_for_block(now + idle_period);
            } else {
                publisher_.wait_for_subscriptions(waiting_period);
            }
            continue;
        }
        const Nanoseconds lateness = hold_until_due(*block, stop);
        if (stop.load(std::memory_order_relaxed)) {
            return;
        }
        judge_load(*block, lateness);
        // The last moment: a subscriber that came meanwhile gets meta before this block.
        listen_for_subscriptions();
        release(*block);
        monitor_.count(*block, lateness);
        producer_.pop();
    }
}

/// Blocks of a stopped stream that lie in the ring although later ones have been discarded: as good as discarded.
std::uint64_t Pipeline::passed_over() {
    std::uint64_t count = 0;
    const Block* block = producer_.front();
    while (block != nullptr && block->samples().first < producer_.discarded_to()) {
        ++count;
        producer_.pop();
        block = producer_.front();
    }
    return count;
}

void Pipeline::start_when_ready(Nanoseconds now) {
    if (start_time_) {
        return;
    }
    const bool gathered = first_subscription_ && now - *first_subscription_ >= gathering;
    if (options_.start == StreamStart::at_once || gathered) {
        start_time_ = pacer_.flat_out() ? now : now + head_start;
        pacer_.start(*start_time_);
        producer_.go();
        if (events_->starts) {
            events_->starts();
        }
    }
}

/// Returns how late the next block is at least, which has still to be made.
Nanoseconds Pipeline::lateness_of_next(Nanoseconds now) const noexcept {
    if (!start_time_) {
        return Nanoseconds{0};
    }
    const std::int64_t end = monitor_.meters().samples - producer_.origin() + format_.frame_samples;
    return pacer_.lateness(now, deadline_of(end, producer_.ring().capacity()));
}

/// Returns the sample until whose time a block is held: its end, rounded up to the release period.
/// @param end from the stream's first sample on @param blocks there is room for
std::uint64_t Pipeline::deadline_of(std::int64_t end, std::size_t blocks) const noexcept {
    const std::uint64_t grain = samples_per_release(format_, options_.pace, blocks);
    return (static_cast<std::uint64_t>(end) + grain - 1) / grain * grain;
}

/// Waits until the block is due. @returns how late it then is.
Nanoseconds Pipeline::hold_until_due(const Block& block, const std::atomic<bool>& stop) {
    if (pacer_.flat_out()) {
        return Nanoseconds{0};
    }
    monitor_.look_at(producer_.ring());
    const std::int64_t end =
        block.samples().first - producer_.origin() + static_cast<std::int64_t>(block.samples().count);
    const std::uint64_t deadline = deadline_of(end, producer_.room_for(block));
    MonotonicClock clock;
    wait_until_due(clock, pacer_, deadline, [&] {
        listen_for_subscriptions();
        report(MonotonicClock::now());
        return !stop.load(std::memory_order_relaxed);
    });
    return pacer_.lateness(MonotonicClock::now(), deadline);
}

/// Sheds taps that there is not time for. A stream that may fall behind needs none of that.
void Pipeline::judge_load(const Block& block, Nanoseconds lateness) {
    if (pacer_.flat_out() || options_.on_overrun == OnOverrun::wait) {
        return;
    }
    shedder_.judge(demand_.taken(), lateness, block.dropped, MonotonicClock::now());
    if (const TapSet shed = shedder_.shed(); !shed.empty() && !warned_of_shedding_) {
        warned_of_shedding_ = true;
        events_->warn(
            fmt::format("there is not time for all streams that subscribers want: frames of the largest are "
                        "left out, first of {0}, "
                        "and counted in {0}_np_dropped and {0}_raw_dropped of meters and end",
                        row_of(*shed.begin()).name));
    }
}

/// Frames of another epoch follow, and meta comes before them.
void Pipeline::enter(const Epoch& epoch) {
    options_.epoch = epoch;
    if (events_->epoch_begins) {
        options_.about.update(events_->epoch_begins(epoch));
    }
    send_meta();
}

void Pipeline::release(const Block& block) {
    if (block.epoch.number != options_.epoch.number) {
        enter(block.epoch);
    }
    demand_.note(block);
    monitor_.count_dropped(block.dropped, demand_);
    frames_.send(block, demand_, monitor_.meters());
    if (recorder_ != nullptr) {
        recorder_->write(block.samples());
    }
}

void Pipeline::listen_for_subscriptions() {
    const Nanoseconds now = MonotonicClock::now();
    if (now - listened_ < subscriptions_period) {
        return;
    }
    listened_ = now;
    const std::size_t news = publisher_.poll_subscriptions();
    demand_.update(publisher_, producer_, shedder_.shed());
    if (!first_subscription_ && !demand_.asked().all().empty()) {
        first_subscription_ = now;
    }
    if (news > 0) {
        send_meta();
    }
    if (!warned_of_too_many_clients_ && publisher_.has_had_too_many_clients()) {
        warned_of_too_many_clients_ = true;
        events_->warn("more than " + std::to_string(publisher_.max_clients()) +
                      " clients want to be connected (--max-clients): those without a subscription, then "
                      "the latest are disconnected until others leave");
    }
}

/// Meters ten times, meta once a second.
void Pipeline::report(Nanoseconds now) {
    if (now >= next_meters_) {
        next_meters_ = now + meters_period;
        monitor_.look_at(producer_.ring());
        if (start_time_) {
            monitor_.measure(now, *start_time_, producer_.busy());
        }
        if (publisher_.wanted(meters_topic)) {
            producer_.want_motion();
            publisher_.send_text(meters_topic, meters_json(monitor_.meters(), format_.taps, options_.run));
        }
        monitor_.meters().drive = source_.drive();
        for (const std::string& text : source_.take_warnings()) {
            events_->warn(text);
        }
        events_->progress(monitor_.meters());
        watch();
    }
    if (now >= next_meta_) {
        next_meta_ = now + meta_period;
        if (publisher_.wanted(meta_topic)) {
            send_meta();
        }
    }
}

/// Publishes meta again, when its estimate of the error may no longer hold.
void Pipeline::watch() {
    if (!events_->watch) {
        return;
    }
    producer_.want_motion();
    const Json changed = events_->watch(monitor_.meters().motion);
    if (!changed.empty()) {
        options_.about.update(changed);
        send_meta();
    }
}

void Pipeline::send_meta() {
    publisher_.send_text(meta_topic, meta_json(options_, format_));
}

std::string make_run_id() {
    // The device itself and not a generator seeded by it: two runs started at once must differ in all bits.
    std::random_device random;
    std::array<std::uint32_t, 4> words{};
    for (std::uint32_t& word : words) {
        word = random();
    }
    words[1] = (words[1] & 0xffff0fffU) | 0x00004000U;  // version 4
    words[2] = (words[2] & 0x3fffffffU) | 0x80000000U;  // variant of RFC 9562
    return fmt::format("{:08x}-{:04x}-{:04x}-{:04x}-{:04x}{:08x}", words[0], words[1] >> 16,
                       words[1] & 0xffffU, words[2] >> 16, words[2] & 0xffffU, words[3]);
}

}  // namespace hertzline::stream
