// The end of a stream, for a slow subscriber.

#include <atomic>
#include <chrono>
#include <thread>

#include <gtest/gtest.h>

#include "stream/pipeline/pipeline.hpp"
#include "stream/wire/frame_codec.hpp"
#include "stream/wire/subscriber.hpp"
#include "stream/wire/topics.hpp"
#include "tests/support/counting_source.hpp"
#include "tests/support/sockets.hpp"
#include "tests/support/temporary_folder.hpp"

namespace hertzline::test {

using namespace stream;
namespace {

using namespace std::chrono_literals;

TEST(LastMessage, ReachesOneWhoseQueueIsFullAndWhoReadsAgainWithinTheLinger) {
    constexpr std::int64_t frames = 3000;  // 12 MB: more than its queue and the system take
    const TemporaryFolder folder;
    CountingSource source({.taps = TapSet(Tap::v_out),
                           .counts = {.spheres = 1, .points = 2},
                           .sample_rate_hz = 1e7,
                           .frame_samples = 1000});
    Publisher publisher("ipc://" + folder.file("s"), all_topics,
                        {.max_queue_length = 10, .linger = patience});
    std::atomic<bool> all_sent{false};
    std::int64_t heard = 0;
    bool ended = false;
    std::thread reader([&] {
        Subscriber subscriber(publisher.endpoint(), {.receive_high_water_mark = 10});
        subscriber.subscribe(topics_of(Tap::v_out).np);
        subscriber.subscribe(end_topic);
        all_sent.wait(false);
        std::this_thread::sleep_for(300ms);  // the first end has come to a full queue
        const Message* message = nullptr;
        while (!ended && (message = subscriber.receive(patience)) != nullptr) {
            ended = message->topic() == end_topic;
            heard += ended ? 0 : 1;
        }
        if (ended) {
            EXPECT_EQ(message->text(0), "{\"samples\":3000000}");
        }
    });
    Pipeline pipeline({.about = {{"version", "test"}},
                       .pace = Pace::flat_out(),
                       .samples = frames * 1000,
                       .start = StreamStart::with_first_subscriber},
                      source, publisher, nullptr);
    const std::atomic<bool> stop{false};
    const StreamMeters meters =
        pipeline.run(stop, {.progress = [](const StreamMeters&) {},
                            .warn = [](const std::string&) {},
                            .summary =
                                [&](const StreamMeters& now) {
                                    all_sent = true;
                                    all_sent.notify_one();
                                    return "{\"samples\":" + std::to_string(now.samples) + "}";
                                }});
    reader.join();
    // where it reads nothing for long, it counts as wanting nothing
    EXPECT_LE(meters.np(Tap::v_out).sent, frames);
    EXPECT_GE(meters.np(Tap::v_out).sent, heard);
    EXPECT_LT(heard, frames) << "its queue was never full: this tests nothing";
    EXPECT_TRUE(ended);
}

}  // namespace
}  // namespace hertzline::test
