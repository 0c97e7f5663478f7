// The stream as a whole: simulated samples come out of the socket, counted.

#include "stream/pipeline/pipeline.hpp"

#include <array>
#include <atomic>
#include <cmath>
#include <map>
#include <optional>
#include <thread>

#include <gtest/gtest.h>

#include "core/scene/json.hpp"
#include "hertzline/resolve.hpp"
#include "recordings/float32.hpp"
#include "stream/inputs/simulation_source.hpp"
#include "stream/wire/continuity.hpp"
#include "stream/wire/frame_codec.hpp"
#include "stream/wire/subscriber.hpp"
#include "stream/wire/topics.hpp"
#include "tests/support/allocation_count.hpp"
#include "tests/support/counting_source.hpp"
#include "tests/support/sockets.hpp"

namespace hertzline::test {

using namespace recordings;
using namespace stream;
namespace {

constexpr TapSet everything = streamed_taps;

Scene repeated_bursts() {
    Scene scene;
    scene.drive.repetition_hz = 1000;
    return resolve(scene).scene;
}

StreamOptions options(Pace pace, std::int64_t samples, StreamStart start) {
    return {.about = {{"version", "test"}}, .pace = pace, .samples = samples, .start = start};
}

/// Listens to a tap of a publisher in a thread of its own, until the end of the run.
class Listener {
public:
    Listener(const std::string& endpoint, std::vector<Tap> taps)
        : taps_(std::move(taps)), thread_([this, endpoint] { run(endpoint); }) {}
    void join() { thread_.join(); }

    std::map<Tap, std::vector<float>> samples;
    std::map<Tap, ContinuityCheck> checks;
    std::vector<FrameHeader> headers;

private:
    void run(const std::string& endpoint) {
        Subscriber subscriber(endpoint, {.receive_high_water_mark = 100'000});
        std::map<std::string, Tap, std::less<>> topics;
        for (const Tap tap : taps_) {
            topics[std::string(std::string_view(topics_of(tap).np))] = tap;
            subscriber.subscribe(topics_of(tap).np);
        }
        subscriber.subscribe(end_topic);
        std::vector<float> part;
        while (const Message* message = subscriber.receive(patience)) {
            if (message->topic() == end_topic) {
                return;
            }
            const Tap tap = topics.find(message->topic())->second;
            const auto header = decode_header(message->text(0), message->bytes(1).size());
            ASSERT_TRUE(header) << header.error();
            checks[tap].take(*header);
            headers.push_back(*header);
            ASSERT_TRUE(decode_samples(message->bytes(1), part));
            samples[tap].insert(samples[tap].end(), part.begin(), part.end());
        }
        ADD_FAILURE() << "no end came";
    }

    std::vector<Tap> taps_;
    std::thread thread_;
};

struct Stream {
    explicit Stream(StreamOptions with)
        : source(scene, TapSet()),
          publisher("tcp://127.0.0.1:*"),
          pipeline(std::move(with), source, publisher, nullptr) {}

    using Watch = std::function<Json(const MotionExtremes&)>;
    static Json no_change(const MotionExtremes& /*now*/) { return {}; }

    StreamMeters run(
        const std::function<void(const StreamMeters&)>& progress = [](const StreamMeters&) {},
        const Watch& watch = no_change) {
        return pipeline.run(stop, {.progress = progress,
                                   .warn = [](const std::string&) {},
                                   .watch = watch,
                                   .summary = [](const StreamMeters&) { return std::string("{}"); }});
    }

    Scene scene = repeated_bursts();
    SimulationSource source;
    Publisher publisher;
    Pipeline pipeline;
    std::atomic<bool> stop{false};
};

/// Streams that source from start to end.
StreamMeters run(StreamOptions with, SampleSource& source, Publisher& publisher) {
    Pipeline pipeline(std::move(with), source, publisher, nullptr);
    const std::atomic<bool> stop{false};
    return pipeline.run(stop, {.progress = [](const StreamMeters&) {},
                               .warn = [](const std::string&) {},
                               .summary = [](const StreamMeters&) { return "{}"; }});
}

TEST(Pipeline, EverySampleOfEveryStreamArrivesBitForBit) {
    constexpr std::int64_t samples = 20'500;  // the last frame is a short one
    Stream stream(options(Pace::flat_out(), samples, StreamStart::with_first_subscriber));
    Listener listener(stream.publisher.endpoint(), {Tap::v_out, Tap::v_last, Tap::v_plate, Tap::v_chain});
    const StreamMeters meters = stream.run();
    listener.join();
    EXPECT_EQ(meters.samples, samples);
    EXPECT_EQ(meters.dropped_frames, 0);

    Simulation simulation(stream.scene, {.taps = everything});
    Samples expected = simulation.make_samples(samples);
    EXPECT_EQ(simulation.advance(expected, samples), Status::running);
    for (const Tap tap : {Tap::v_out, Tap::v_last, Tap::v_plate, Tap::v_chain}) {
        EXPECT_TRUE(listener.checks[tap].gapless());
        EXPECT_EQ(listener.samples[tap], std::vector<float>(expected[tap].begin(), expected[tap].end()))
            << row_of(tap).name;
    }
    EXPECT_EQ(meters.account.steps, simulation.steps());
    EXPECT_EQ(meters.account.contact_events, simulation.contact_events());
}

TEST(Pipeline, HeadersSayInWhichBurstTheirFirstSampleLies) {
    const auto headers_of = [](double repetition_hz) {
        CountingSource source({.taps = Tap::v_out,
                               .counts = {.spheres = 1, .points = 2},
                               .sample_rate_hz = 1e7,
                               .frame_samples = 1024,
                               .repetition_hz = repetition_hz});
        Publisher publisher("tcp://127.0.0.1:*");
        Listener listener(publisher.endpoint(), {Tap::v_out});
        run(options(Pace::flat_out(), 100'000, StreamStart::with_first_subscriber), source, publisher);
        listener.join();
        EXPECT_EQ(listener.headers.size(), 98U);
        return listener.headers;
    };
    for (const FrameHeader& header :
         headers_of(997)) {  // 10030.09 samples: the bursts begin at 10031, 20061...
        const auto burst = static_cast<std::uint64_t>(static_cast<double>(header.sample) * 997 / 1e7);
        EXPECT_EQ(header.burst, burst);
        const double start = std::ceil(static_cast<double>(burst) * 1e7 / 997);
        EXPECT_EQ(header.burst_sample, header.sample - static_cast<std::uint64_t>(start));
    }
    for (const FrameHeader& header : headers_of(0)) {
        EXPECT_EQ(header.burst, 0U);
        EXPECT_EQ(header.burst_sample, header.sample);
    }
}

TEST(Pipeline, TheSimulatingThreadAllocatesNothing) {
    if (HERTZLINE_ALLOCATIONS_ARE_COUNTED == 0) {
        GTEST_SKIP() << "sanitizers bring an allocator of their own";
    }
    Stream stream(options(Pace::flat_out(), 300'000, StreamStart::with_first_subscriber));
    Listener listener(stream.publisher.endpoint(), {Tap::v_out, Tap::v_chain});
    const AllocationsOfThread simulating(simulating_thread_name);
    EXPECT_EQ(stream.run().samples, 300'000);
    listener.join();
    EXPECT_EQ(simulating.so_far(), 0U);
}

TEST(Pipeline, WhatTheWatchFindsIsInMeta) {
    Stream stream(options(Pace::factor(0.1), 1'000'000'000, StreamStart::at_once));
    Subscriber subscriber(stream.publisher.endpoint());
    subscriber.subscribe(meta_topic);
    std::thread listening([&] {
        while (const Message* message = subscriber.receive(std::chrono::seconds(60))) {
            if (const auto meta = nlohmann::json::parse(message->text(0)); meta["version"] == "changed") {
                EXPECT_EQ(meta["fs"], stream.pipeline.format().sample_rate_hz);  // and all else that it says
                break;
            }
        }
        stream.stop = true;
    });
    double seen_s = 0;
    const StreamMeters meters = stream.run([](const StreamMeters&) {},
                                           [&](const MotionExtremes& now) -> Json {
                                               const bool first = seen_s == 0 && now.time_s > 0;
                                               seen_s = std::max(seen_s, now.time_s);
                                               return first ? Json{{"version", "changed"}} : Json::object();
                                           });
    listening.join();
    EXPECT_GT(seen_s, 0);
    EXPECT_GE(meters.motion.time_s, seen_s);
}

TEST(Pipeline, AStalledSenderDiscardsFramesAndCountsThem) {
    // ten times slower than real time, so that this machine's load does not matter; the sender sleeps longer
    // than the ring lasts
    Stream stream(options(Pace::factor(0.1), 2'000'000, StreamStart::with_first_subscriber));
    Listener listener(stream.publisher.endpoint(), {Tap::v_out});
    bool stalled = false;
    const StreamMeters meters = stream.run([&](const StreamMeters& now) {
        if (!stalled && now.frames > 0 && now.frames < 1000) {
            stalled = true;
            std::this_thread::sleep_for(std::chrono::milliseconds(800));
        }
    });
    listener.join();
    const ContinuityTotals& totals = listener.checks[Tap::v_out].totals();
    EXPECT_GT(meters.dropped_frames, 0);
    EXPECT_GT(meters.late_frames, 0);
    EXPECT_EQ(totals.lost_on_the_way, 0U);
    EXPECT_GT(totals.dropped_by_sender, 0U);
    EXPECT_LE(totals.dropped_by_sender, static_cast<std::uint64_t>(meters.dropped_frames));
    EXPECT_EQ(totals.inconsistent, 0U);
    // each frame of the topic is counted
    const TopicCount& count = meters.np(Tap::v_out);
    EXPECT_EQ(count.sent, static_cast<std::int64_t>(totals.frames));
    EXPECT_EQ(count.dropped, meters.dropped_frames);
    EXPECT_EQ(count.sent + count.dropped, meters.frames + meters.dropped_frames);
    EXPECT_EQ(meters.raw(Tap::v_out).sent, 0);
    EXPECT_GT(meters.largest_lateness_s, 0.5);
}

/// Lacks v_chain in its first blocks, and in some later ones: as the samples ahead of an array's delayed chains do.
class LacksTheChain : public CountingSource {
public:
    using CountingSource::CountingSource;
    bool read(Samples& samples, std::size_t count, TapSet wanted) noexcept override {
        const bool more = CountingSource::read(samples, count, wanted);
        if (const std::int64_t frame = samples.first / 1000; frame < 3 || frame % 10 == 5) {
            samples.holds = samples.holds - Tap::v_chain;
        }
        return more;
    }
};

TEST(Pipeline, AFrameThatASourceCannotGiveIsCounted) {
    LacksTheChain source({.taps = everything,
                          .counts = {.spheres = 6, .points = 2},
                          .sample_rate_hz = 1e7,
                          .frame_samples = 1000});
    Publisher publisher("tcp://127.0.0.1:*");
    Listener listener(publisher.endpoint(), {Tap::v_out, Tap::v_chain});
    subscriptions_until_wanted(publisher, "v_chain/np");
    const StreamMeters meters =
        run(options(Pace::flat_out(), 100'000, StreamStart::at_once), source, publisher);
    listener.join();
    EXPECT_TRUE(listener.checks[Tap::v_out].gapless());
    const ContinuityTotals& chain = listener.checks[Tap::v_chain].totals();
    EXPECT_EQ(chain.frames, 87U);  // of 100; three before the first one are none of its stream
    EXPECT_EQ(chain.dropped_by_sender, 10U);
    EXPECT_EQ(chain.lost_on_the_way, 0U);
    EXPECT_EQ(meters.np(Tap::v_chain).dropped, 10);
}

TEST(Pipeline, WhatIsDiscardedAtTheVeryEndIsInTheEnd) {
    // 0.2 s long; the sender wakes up long after that
    Stream stream(options(Pace::factor(0.1), 200'000, StreamStart::with_first_subscriber));
    Listener listener(stream.publisher.endpoint(), {Tap::v_out});
    bool stalled = false;
    const StreamMeters meters = stream.run([&](const StreamMeters& now) {
        if (!stalled && now.frames > 0) {
            stalled = true;
            std::this_thread::sleep_for(std::chrono::milliseconds(800));
        }
    });
    listener.join();
    EXPECT_GT(meters.dropped_frames, 0);
    EXPECT_LT(listener.samples[Tap::v_out].size(), 200'000U);
    EXPECT_EQ(meters.samples, 200'000);
    EXPECT_DOUBLE_EQ(meters.simulated_s, 0.02);
}

TEST(Pipeline, AStreamThatIsStoppedAfterAStallAccountsForEveryFrame) {
    Stream stream(options(Pace::factor(0.1), 1'000'000'000, StreamStart::with_first_subscriber));
    Listener listener(stream.publisher.endpoint(), {Tap::v_out});
    const StreamMeters meters = stream.run([&](const StreamMeters& now) {
        if (!stream.stop && now.frames > 0) {
            std::this_thread::sleep_for(std::chrono::milliseconds(800));  // longer than the ring lasts
            stream.stop = true;
        }
    });
    listener.join();
    EXPECT_GT(meters.dropped_frames, 0);
    // the last of those that are discarded may be broken off
    const std::int64_t length = stream.scene.output.frame_samples;
    EXPECT_EQ(meters.frames + meters.dropped_frames, (meters.samples + length - 1) / length);
    EXPECT_EQ(meters.np(Tap::v_out).sent, meters.frames);
    EXPECT_EQ(meters.np(Tap::v_out).dropped, meters.dropped_frames);
}

TEST(Pipeline, AStalledSenderFallsBehindWhenNothingMayBeDiscarded) {
    StreamOptions patient = options(Pace::factor(0.1), 500'000, StreamStart::with_first_subscriber);
    patient.on_overrun = OnOverrun::wait;
    Stream stream(std::move(patient));
    Listener listener(stream.publisher.endpoint(), {Tap::v_out});
    bool stalled = false;
    const StreamMeters meters = stream.run([&](const StreamMeters& now) {
        if (!stalled && now.frames > 0) {
            stalled = true;
            std::this_thread::sleep_for(std::chrono::milliseconds(800));
        }
    });
    listener.join();
    EXPECT_TRUE(listener.checks[Tap::v_out].gapless());
    EXPECT_EQ(listener.samples[Tap::v_out].size(), 500'000U);
    EXPECT_EQ(meters.dropped_frames, 0);
    EXPECT_GT(meters.late_frames, 0);
}

/// Receives `frames` frames of v_last as a new subscriber, and leaves.
std::uint64_t lost_by_a_visitor(const std::string& endpoint, std::uint64_t frames) {
    Subscriber visitor(endpoint);
    visitor.subscribe("v_last/np");
    ContinuityCheck check;
    while (check.totals().frames < frames) {
        const Message* message = visitor.receive(patience);
        if (message == nullptr) {
            ADD_FAILURE() << "no frame came";
            break;
        }
        check.take(*decode_header(message->text(0), message->bytes(1).size()));
    }
    return check.totals().lost_on_the_way;
}

TEST(Pipeline, WhoComesSoonAfterAnotherLeftHearsAWholeStream) {
    // Slow enough for this machine's load not to matter. The ring lasts 50 ms: 50 frames.
    Stream stream(options(Pace::factor(0.1), 1'000'000'000, StreamStart::at_once));
    std::thread visitors([&] {
        for (int visit = 0; visit < 5; ++visit) {
            EXPECT_EQ(lost_by_a_visitor(stream.publisher.endpoint(), 3), 0U);
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
            EXPECT_EQ(lost_by_a_visitor(stream.publisher.endpoint(), 100), 0U);
        }
        stream.stop = true;
    });
    stream.run();
    visitors.join();
}

TEST(Pipeline, OnlyWhatSomebodySubscribesToIsSampled) {
    const auto asked_for = [](const std::vector<Tap>& subscribed) {
        CountingSource source({.taps = everything,
                               .counts = {.spheres = 6, .points = 2},
                               .sample_rate_hz = 1e7,
                               .frame_samples = 1000});
        Publisher publisher("tcp://127.0.0.1:*");
        std::optional<Listener> listener;
        if (!subscribed.empty()) {
            listener.emplace(publisher.endpoint(), subscribed);
        }
        const StreamStart start = listener ? StreamStart::with_first_subscriber : StreamStart::at_once;
        EXPECT_EQ(run(options(Pace::flat_out(), 100'000, start), source, publisher).samples, 100'000);
        if (listener) {
            listener->join();
        }
        return source.asked_for();
    };
    EXPECT_EQ(asked_for({}), TapSet());
    EXPECT_EQ(asked_for({Tap::v_chain}), TapSet(Tap::v_chain));
}

/// A subscriber to everything that reads nothing until it is told to.
class Greedy {
public:
    explicit Greedy(const std::string& endpoint) : socket_(context_, zmq::socket_type::sub) {
        socket_.set(zmq::sockopt::linger, 0);
        socket_.set(zmq::sockopt::rcvhwm, 1);  // then the system's buffers fill
        socket_.set(zmq::sockopt::subscribe, "");
        socket_.connect(endpoint);
    }
    void begin_to_read() {
        thread_ = std::jthread([this](const std::stop_token& stop) { read(stop); });
    }
    void join() { thread_.join(); }

    ContinuityCheck chain;  // of v_chain/np
    std::atomic<bool> hears_of_dropped_frames{false};

private:
    void read(const std::stop_token& stop) {
        socket_.set(zmq::sockopt::rcvtimeo, 100);
        std::array<zmq::message_t, 3> parts;
        while (!stop.stop_requested()) {
            std::size_t count = 0;
            while (count < parts.size() && socket_.recv(parts[count]) && parts[count++].more()) {
            }
            if (count == 3 && parts[0].to_string_view() == topics_of(Tap::v_chain).np) {
                chain.take(*decode_header(parts[1].to_string_view(), parts[2].size()));
                hears_of_dropped_frames = chain.totals().dropped_by_sender > 0;
            } else if (count > 0 && parts[0].to_string_view() == end_topic) {
                return;
            }
        }
    }

    zmq::context_t context_;
    zmq::socket_t socket_;
    std::jthread thread_;
};

// The stream is ten times slower than real time, and may fall behind, so that this machine's load does not matter.
TEST(Pipeline, WhatWhoStopsReadingAskedForIsNotComputedUntilItReadsAgain) {
    CountingSource source({.taps = everything,
                           .counts = {.spheres = 6, .points = 2},
                           .sample_rate_hz = 1e7,
                           .frame_samples = 1000});
    Publisher publisher("tcp://127.0.0.1:*");
    Greedy greedy(publisher.endpoint());
    Listener listener(publisher.endpoint(), {Tap::v_out});
    subscriptions_until_wanted(publisher, "v_chain/raw");
    subscriptions_until_wanted(publisher, "v_out/np");
    StreamOptions patient = options(Pace::factor(0.1), 1'000'000'000, StreamStart::at_once);
    patient.on_overrun = OnOverrun::wait;
    Pipeline pipeline(std::move(patient), source, publisher, nullptr);
    std::atomic<bool> stop{false};
    bool frozen = false;
    const StreamMeters meters =
        pipeline.run(stop, {.progress =
                                [&](const StreamMeters& now) {
                                    if (!frozen && source.asked_last() == TapSet(Tap::v_out)) {
                                        frozen = true;
                                        greedy.begin_to_read();
                                    }
                                    stop = greedy.hears_of_dropped_frames || now.frames > 60'000;
                                },
                            .warn = [](const std::string&) {},
                            .summary = [](const StreamMeters&) { return "{}"; }});
    ASSERT_TRUE(frozen);
    listener.join();
    greedy.join();
    EXPECT_EQ(source.asked_last(), everything) << "it reads again";
    EXPECT_TRUE(listener.checks[Tap::v_out].gapless());
    EXPECT_EQ(meters.np(Tap::v_out).sent, meters.frames);
    for (const Tap tap : {Tap::v_chain, Tap::v_horn}) {
        EXPECT_GT(meters.np(tap).dropped, 0);
        EXPECT_EQ(meters.np(tap).sent + meters.np(tap).dropped, meters.frames);
        EXPECT_EQ(meters.raw(tap).sent + meters.raw(tap).dropped, meters.frames);
    }
    const ContinuityTotals& heard = greedy.chain.totals();
    EXPECT_GT(heard.dropped_by_sender, 0U);
    EXPECT_EQ(heard.inconsistent, 0U);
    EXPECT_EQ(heard.missing_samples, 1000 * (heard.dropped_by_sender + heard.lost_on_the_way));
}

/// Takes three times as long as there is for the taps of the chain.
class SlowWithTheChain : public CountingSource {
public:
    using CountingSource::CountingSource;
    bool read(Samples& samples, std::size_t count, TapSet wanted) noexcept override {
        if (!(wanted & format().of_chain()).empty()) {
            std::this_thread::sleep_for(std::chrono::milliseconds(3));
        }
        return CountingSource::read(samples, count, wanted);
    }
};

TEST(Pipeline, WithoutTimeForAllTheLargestTapsAreLeftOutAndCounted) {
    SlowWithTheChain source({.taps = everything,
                             .counts = {.spheres = 6, .points = 2},
                             .sample_rate_hz = 1e7,
                             .frame_samples = 1000});
    Publisher publisher("tcp://127.0.0.1:*");
    Listener greedy(publisher.endpoint(), {Tap::v_out, Tap::v_chain});
    Listener listener(publisher.endpoint(), {Tap::v_out});
    subscriptions_until_wanted(publisher, "v_chain/np");
    subscriptions_until_wanted(publisher, "v_out/np");
    Pipeline pipeline(options(Pace::factor(0.1), 1'000'000'000, StreamStart::at_once), source, publisher,
                      nullptr);
    std::atomic<bool> stop{false};
    std::vector<std::string> warnings;
    const StreamMeters meters = pipeline.run(
        stop, {.progress =
                   [&](const StreamMeters& now) {
                       stop = now.np(Tap::v_chain).dropped - now.dropped_frames >= 200 || now.frames > 10'000;
                   },
               .warn = [&](const std::string& text) { warnings.push_back(text); },
               .summary = [](const StreamMeters&) { return "{}"; }});
    listener.join();
    greedy.join();
    EXPECT_GE(meters.np(Tap::v_chain).dropped - meters.dropped_frames, 200);
    const std::int64_t all = meters.frames + meters.dropped_frames;
    EXPECT_EQ(meters.np(Tap::v_chain).sent + meters.np(Tap::v_chain).dropped, all);
    EXPECT_EQ(meters.np(Tap::v_out).sent, meters.frames) << "one that has time";
    for (Listener* each : {&listener, &greedy}) {
        EXPECT_EQ(each->checks[Tap::v_out].totals().frames, static_cast<std::uint64_t>(meters.frames));
        EXPECT_EQ(each->checks[Tap::v_out].totals().lost_on_the_way, 0U);
    }
    const ContinuityTotals& heard = greedy.checks[Tap::v_chain].totals();
    EXPECT_EQ(heard.frames, static_cast<std::uint64_t>(meters.np(Tap::v_chain).sent));
    EXPECT_EQ(heard.lost_on_the_way, 0U);
    ASSERT_EQ(warnings.size(), 1U);
    EXPECT_NE(warnings[0].find("v_chain_np_dropped"), std::string::npos);
}

TEST(Pipeline, DiscardsNothingOfALongChainWhoseSpheresNobodyWants) {
    // An idle machine discards none, a program that builds them every second one, each time.
    const auto discards_few = [] {
        CountingSource source({.taps = everything,
                               .counts = {.spheres = 1500, .points = 2},
                               .sample_rate_hz = 1e7,
                               .frame_samples = 1024});
        Publisher publisher("tcp://127.0.0.1:*");
        const StreamMeters meters =
            run(options(Pace::realtime(), 5'000'000, StreamStart::at_once), source, publisher);
        return meters.dropped_frames < meters.frames / 10;
    };
    EXPECT_TRUE(eventually(discards_few));
}

TEST(Pipeline, StopsWhenAsked) {
    Stream stream(options(Pace::realtime(), std::int64_t{1} << 50, StreamStart::at_once));
    const StreamMeters meters = stream.run([&](const StreamMeters& now) { stream.stop = now.frames > 0; });
    EXPECT_GT(meters.frames, 0);
    EXPECT_LT(meters.samples, std::int64_t{1} << 40);
}

}  // namespace
}  // namespace hertzline::test
