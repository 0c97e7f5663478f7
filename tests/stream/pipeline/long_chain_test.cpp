// A stream of every sphere of a long chain: frames of megabytes, and a ring of few blocks.

#include <atomic>
#include <cstring>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "hertzline/resolve.hpp"
#include "recordings/float32.hpp"
#include "stream/inputs/simulation_source.hpp"
#include "stream/pipeline/pipeline.hpp"
#include "stream/wire/continuity.hpp"
#include "stream/wire/frame_codec.hpp"
#include "stream/wire/subscriber.hpp"
#include "stream/wire/topics.hpp"
#include "tests/support/counting_source.hpp"
#include "tests/support/ends.hpp"
#include "tests/support/sanitized.hpp"

namespace hertzline::test {

using namespace recordings;
using namespace stream;
namespace {

constexpr std::size_t spheres = 2000;
constexpr std::size_t frame_samples = 128;  // 1 MB

/// Receives v_chain to the end of the run, in a thread of its own.
class ChainListener {
public:
    using Take = std::function<void(const FrameHeader&, std::span<const float>)>;

    ChainListener(const std::string& endpoint, Take take)
        : take_(std::move(take)), thread_([this, endpoint] { listen(endpoint); }) {}
    void join() { thread_.join(); }
    const ContinuityCheck& check() const { return check_; }

private:
    void listen(const std::string& endpoint) {
        Subscriber subscriber(endpoint, {.receive_high_water_mark = 100'000});
        subscriber.subscribe(topics_of(Tap::v_chain).np);
        subscriber.subscribe(end_topic);
        std::vector<float> samples;
        while (const Message* message = subscriber.receive(std::chrono::seconds(60))) {
            if (message->topic() == end_topic) {
                return;
            }
            const auto header = decode_header(message->text(0), message->bytes(1).size());
            ASSERT_TRUE(header) << header.error();
            ASSERT_EQ(header->channels, spheres);
            ASSERT_EQ(message->bytes(1).size(), header->n * spheres * sizeof(float));
            ASSERT_TRUE(decode_samples(message->bytes(1), samples));
            check_.take(*header);
            take_(*header, samples);
        }
        ADD_FAILURE() << "no end came";
    }

    Take take_;
    ContinuityCheck check_;
    std::thread thread_;
};

StreamMeters streamed(StreamOptions options, SampleSource& source, Publisher& publisher) {
    Pipeline pipeline(std::move(options), source, publisher, nullptr);
    const std::atomic<bool> stop{false};
    return pipeline.run(stop, {.progress = [](const StreamMeters&) {},
                               .warn = [](const std::string&) {},
                               .summary = [](const StreamMeters&) { return "{}"; }});
}

StreamOptions options(Pace pace, std::int64_t samples) {
    return {.about = {{"version", "test"}},
            .pace = pace,
            .samples = samples,
            .start = StreamStart::with_first_subscriber,
            .on_overrun = OnOverrun::wait};
}

Scene long_chain() {
    Scene scene;
    scene.chain.spheres = spheres;
    scene.end.kind = EndKind::wall;
    scene.output.frame_samples = frame_samples;
    return resolve(scene).scene;
}

TEST(LongChain, EverySampleOfEverySphereArrivesBitForBit) {
    const Scene scene = long_chain();
    SimulationSource source(scene, TapSet());
    const RingSize ring = ring_size(source.format(), Pace::flat_out());
    const auto blocks = static_cast<std::int64_t>(3 * ring.chain_blocks + repeated(40));  // around the ring
    const std::int64_t samples = blocks * static_cast<std::int64_t>(frame_samples) + 50;
    Publisher publisher("tcp://127.0.0.1:*", all_topics,
                        {.queue_bytes = 4e9, .largest_message = largest_frame_bytes(source.format())});

    Simulation simulation(scene, {.taps = TapSet(Tap::v_chain)});
    Samples expected = simulation.make_samples(frame_samples);
    std::vector<float> floats;
    std::int64_t wrong = 0;
    ChainListener listener(publisher.endpoint(), [&](const FrameHeader& header, std::span<const float> got) {
        EXPECT_EQ(simulation.advance(expected, header.n), Status::running);
        floats.assign(expected[Tap::v_chain].begin(), expected[Tap::v_chain].end());
        const bool same =
            floats.size() == got.size() && std::memcmp(floats.data(), got.data(), got.size_bytes()) == 0;
        wrong += same ? 0 : 1;
        EXPECT_TRUE(header.n == frame_samples || header.n == 50U) << header.n;
    });
    const StreamMeters meters = streamed(options(Pace::flat_out(), samples), source, publisher);
    listener.join();
    EXPECT_EQ(meters.samples, samples);
    EXPECT_EQ(meters.dropped_frames, 0);
    EXPECT_EQ(wrong, 0) << "frames";
    EXPECT_TRUE(listener.check().gapless()) << listener.check().text();
    EXPECT_EQ(listener.check().totals().frames, static_cast<std::uint64_t>(blocks + 1));
}

TEST(LongChain, IsSentInStepWithTheClockFromTheFewSlotsThatItHas) {
    CountingSource source({.taps = streamed_taps_of(scene_with_end(EndKind::wall)),
                           .counts = {.spheres = spheres, .points = 2},
                           .sample_rate_hz = 1e7,
                           .frame_samples = frame_samples});
    constexpr std::int64_t samples = 40 * frame_samples;  // in half a second
    Publisher publisher("tcp://127.0.0.1:*", all_topics,
                        {.queue_bytes = 4e9, .largest_message = largest_frame_bytes(source.format())});
    std::int64_t next = 0;
    std::int64_t wrong = 0;
    ChainListener listener(publisher.endpoint(), [&](const FrameHeader& header, std::span<const float> got) {
        for (std::size_t i = 0; i < got.size(); ++i) {
            const auto sample = next + static_cast<std::int64_t>(i / spheres);
            wrong += got[i] == static_cast<float>(sample) ? 0 : 1;
        }
        next += static_cast<std::int64_t>(header.n);
    });
    const StreamMeters meters = streamed(options(Pace::factor(1e-3), samples), source, publisher);
    listener.join();
    EXPECT_EQ(meters.samples, samples);
    EXPECT_EQ(next, samples);
    EXPECT_EQ(wrong, 0) << "numbers";
    EXPECT_TRUE(listener.check().gapless()) << listener.check().text();
    EXPECT_GT(meters.wall_s, 0.4);
}

}  // namespace
}  // namespace hertzline::test
