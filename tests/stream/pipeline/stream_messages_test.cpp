// The messages of a stream about itself, and their times.

#include "stream/pipeline/stream_messages.hpp"

#include <atomic>
#include <cmath>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stream/pipeline/pipeline.hpp"
#include "stream/wire/subscriber.hpp"
#include "stream/wire/topics.hpp"
#include "tests/support/counting_source.hpp"
#include "tests/support/error_of.hpp"
#include "tests/support/sockets.hpp"

namespace hertzline::test {

using namespace stream;
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

const StreamFormat v_out_alone{.taps = TapSet(Tap::v_out),
                               .counts = {.spheres = 1, .points = 2},
                               .sample_rate_hz = 1e6,
                               .frame_samples = 1000};

StreamMeters streamed(SampleSource& source, Publisher& publisher, StreamOptions options) {
    Pipeline pipeline(std::move(options), source, publisher, nullptr);
    const std::atomic<bool> stop{false};
    return pipeline.run(stop, {.progress = [](const StreamMeters&) {},
                               .warn = [](const std::string&) {},
                               .summary = [](const StreamMeters&) { return "{}"; }});
}

TEST(StreamMessages, MetaComesOnceASecondAndMetersTenTimesThoughNobodyNewComes) {
    CountingSource source(v_out_alone);
    Publisher publisher("tcp://127.0.0.1:*");
    int meta = 0;
    int meters = 0;
    std::thread listening([&] {
        Subscriber subscriber(publisher.endpoint());
        subscriber.subscribe("");  // once
        while (const Message* message = subscriber.receive(patience)) {
            if (message->topic() == end_topic) {
                return;
            }
            meta += message->topic() == meta_topic ? 1 : 0;
            meters += message->topic() == meters_topic ? 1 : 0;
        }
        ADD_FAILURE() << "no end came";
    });
    const StreamMeters said = streamed(source, publisher,
                                       {.about = {{"version", "test"}},
                                        .pace = Pace::factor(0.1),
                                        .samples = 350'000,  // three and a half seconds
                                        .start = StreamStart::with_first_subscriber,
                                        .on_overrun = OnOverrun::wait});
    listening.join();
    // One for the subscription, and one for each whole second. A loaded machine may be late, but never early.
    EXPECT_GE(meta, 3);
    EXPECT_LE(meta, 2 + static_cast<int>(std::ceil(said.wall_s + 1)));
    EXPECT_GE(meters, 15);
    EXPECT_LE(meters, 1 + static_cast<int>(std::ceil(10 * (said.wall_s + 1))));
}

/// A source whose v_out exceeds float32 from sample 5000 on.
class TooLarge final : public CountingSource {
public:
    using CountingSource::CountingSource;
    bool read(Samples& samples, std::size_t count, TapSet wanted) noexcept override {
        const bool more = CountingSource::read(samples, count, wanted);
        if (samples.holds.contains(Tap::v_out)) {
            for (double& value : samples.room(Tap::v_out).first(samples.count)) {
                value = value < 5000 ? value : 1e39;
            }
        }
        return more;
    }
};

TEST(StreamMessages, ASampleThatFloat32CannotHoldFailsTheRunAndIsNotSent) {
    TooLarge source(v_out_alone);
    Publisher publisher("tcp://127.0.0.1:*");
    std::size_t bytes = 0;
    std::atomic<bool> over{false};
    std::thread listening([&] {
        Subscriber subscriber(publisher.endpoint());
        subscriber.subscribe(topics_of(Tap::v_out).raw);
        for (const Message* message = nullptr; !over || message != nullptr;) {
            message = subscriber.receive(100ms);
            bytes += message != nullptr ? message->bytes(0).size() : 0;
        }
    });
    EXPECT_THAT(error_of([&] {
                    streamed(source, publisher,
                             {.about = {{"version", "test"}},
                              .pace = Pace::factor(0.1),
                              .samples = 100'000,
                              .start = StreamStart::with_first_subscriber,
                              .on_overrun = OnOverrun::wait});
                }),
                HasSubstr("a sample of v_out does not fit float32"));
    std::this_thread::sleep_for(200ms);
    over = true;
    listening.join();
    EXPECT_EQ(bytes, 5000 * sizeof(float));
}

}  // namespace
}  // namespace hertzline::test
