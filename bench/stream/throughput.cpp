// Measures how many bytes a second a stream delivers to a subscriber, flat out, beside plain ZeroMQ.
//
//     bench_throughput [--json FILE] [SECONDS]        2 s for each by default
//
// `raw` and `np` are the whole stream without the physics: a source that costs nothing, ring, float32, header, topic.
// `plain` is zmq_send() of one buffer of a frame's size on a PUB socket with the same queue. `parts` sends a topic and a header
// before it, as a frame of NAME/np has them: ZeroMQ's own time for a message of three parts.
// All publish over tcp on loopback to a subscriber in another process, which counts the received bytes of samples. Messages
// that the queue of a slow subscriber discards are not counted.
// Rounds alternate; results are medians.

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <functional>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <sys/wait.h>
#include <unistd.h>

#include "bench/support/arguments.hpp"
#include "core/scene/json.hpp"
#include "measures/resources.hpp"
#include "stream/pipeline/capacity.hpp"
#include "stream/pipeline/pipeline.hpp"
#include "stream/wire/frame_codec.hpp"
#include "stream/wire/subscriber.hpp"
#include "stream/wire/topics.hpp"
#include "tests/support/counting_source.hpp"

namespace {

using namespace hertzline;
using namespace hertzline::stream;
using Clock = std::chrono::steady_clock;

constexpr int rounds = 5;
constexpr const char* any_port = "tcp://127.0.0.1:*";

/// A source that leaves the block's samples as they are.
class StillSource : public test::CountingSource {
public:
    using CountingSource::CountingSource;
    bool read(Samples& samples, std::size_t count, TapSet) noexcept override {
        return CountingSource::read(samples, count, TapSet());
    }
};

struct Received {
    double bytes = 0;
    double seconds = 0;
    double rate() const { return bytes / seconds; }
};

/// Counts the bytes of the last part of every message for `seconds`, from the first message on.
Received count_bytes(const std::string& endpoint, std::string_view topic, double seconds) {
    Subscriber subscriber(endpoint, {.receive_high_water_mark = 65536});
    subscriber.subscribe(topic);
    Received received;
    Clock::time_point begin;
    while (const Message* message = subscriber.receive(std::chrono::seconds(10))) {
        const Clock::time_point now = Clock::now();
        if (received.bytes == 0) {
            begin = now;
        }
        received.bytes += static_cast<double>(
            message->parts() == 0 ? message->topic().size() : message->bytes(message->parts() - 1).size());
        received.seconds = std::chrono::duration<double>(now - begin).count();
        if (received.seconds >= seconds) {
            return received;
        }
    }
    throw std::runtime_error("nothing arrived");
}

/// Publishes here, by `publish(stop)`, while a child process counts the bytes that arrive from the endpoint.
Received measure(const std::string& endpoint, std::string_view topic, double seconds,
                 const std::function<void(std::atomic<bool>&)>& publish) {
    int ends[2];
    if (pipe(ends) != 0) {
        throw std::runtime_error("no pipe");
    }
    const pid_t listener = fork();  // no thread of ours runs yet but ZeroMQ's, which the child does not touch
    if (listener == 0) {
        Received received;
        try {
            received = count_bytes(endpoint, topic, seconds);
        } catch (const std::exception& error) {
            std::fprintf(stderr, "%s\n", error.what());
        }
        _exit(write(ends[1], &received, sizeof received) == sizeof received ? 0 : 1);
    }
    close(ends[1]);
    std::atomic<bool> stop{false};
    std::thread publishing([&] { publish(stop); });
    Received received;
    const bool told = read(ends[0], &received, sizeof received) == sizeof received;
    stop = true;
    publishing.join();
    close(ends[0]);
    waitpid(listener, nullptr, 0);
    if (!told || received.seconds == 0) {
        throw std::runtime_error("the listener received nothing");
    }
    return received;
}

PublisherOptions queues(const StreamFormat& format) {
    return {.queue_bytes = usual_queue_bytes(measures::available_memory_bytes()),
            .largest_message = largest_frame_bytes(format)};
}

double ours(std::int64_t frame_samples, std::string_view topic, double seconds) {
    StillSource source({.taps = TapSet(Tap::v_out),
                        .counts = {.spheres = 1},
                        .sample_rate_hz = 1e7,
                        .frame_samples = frame_samples});
    PublisherOptions options = queues(source.format());
    options.linger = std::chrono::milliseconds(0);
    Publisher publisher(any_port, all_topics, options);
    Pipeline pipeline(
        {.about = Json::object(), .pace = Pace::flat_out(), .start = StreamStart::with_first_subscriber},
        source, publisher, nullptr);
    return measure(publisher.endpoint(), topic, seconds,
                   [&](const std::atomic<bool>& stop) {
                       pipeline.run(stop, {.progress = [](const StreamMeters&) {},
                                           .warn = [](const std::string&) {},
                                           .summary = [](const StreamMeters&) { return std::string("{}"); }});
                   })
        .rate();
}

/// Returns the parts before the samples of a frame of NAME/np.
std::vector<std::string> parts_of_np(std::int64_t frame_samples) {
    FrameHeader header{.stream = "v_out", .fs = 1e7, .run = "00000000-0000-4000-8000-000000000000"};
    header.n = static_cast<std::size_t>(frame_samples);
    std::string json;
    encode_header(header, json);
    return {std::string(topics_of(Tap::v_out).np), std::move(json)};
}

/// Returns the rate of plain ZeroMQ [bytes/s]. @param before parts before the samples
double plain(std::int64_t frame_samples, const std::vector<std::string>& before, double seconds) {
    const StreamFormat format{.taps = TapSet(Tap::v_out),
                              .counts = {.spheres = 1},
                              .sample_rate_hz = 1e7,
                              .frame_samples = frame_samples};
    zmq::context_t context;
    zmq::socket_t socket(context, zmq::socket_type::pub);
    socket.set(zmq::sockopt::sndhwm, queue_length(queues(format)));
    socket.set(zmq::sockopt::linger, 0);
    socket.bind(any_port);
    const std::vector<float> frame(static_cast<std::size_t>(frame_samples), 1.0F);
    return measure(socket.get(zmq::sockopt::last_endpoint), "", seconds,
                   [&](const std::atomic<bool>& stop) {
                       while (!stop) {
                           for (const std::string& part : before) {
                               socket.send(zmq::const_buffer(part.data(), part.size()),
                                           zmq::send_flags::sndmore);
                           }
                           socket.send(zmq::const_buffer(frame.data(), frame.size() * sizeof(float)));
                       }
                   })
        .rate();
}

double median(std::vector<double> values) {
    std::ranges::sort(values);
    return values[values.size() / 2];
}

Json compare(std::int64_t frame_samples, double seconds) {
    std::vector<double> raw, np, alone, parts, raw_ratio, np_ratio, np_parts_ratio;
    for (int round = 0; round < rounds; ++round) {
        raw.push_back(ours(frame_samples, topics_of(Tap::v_out).raw, seconds));
        np.push_back(ours(frame_samples, topics_of(Tap::v_out).np, seconds));
        alone.push_back(plain(frame_samples, {}, seconds));
        parts.push_back(plain(frame_samples, parts_of_np(frame_samples), seconds));
        raw_ratio.push_back(raw.back() / alone.back());
        np_ratio.push_back(np.back() / alone.back());
        np_parts_ratio.push_back(np.back() / parts.back());
    }
    std::printf("%10lld %12.0f %12.0f %12.0f %12.0f %8.2f %8.2f %8.2f\n",
                static_cast<long long>(4 * frame_samples), median(raw) / 1e6, median(np) / 1e6,
                median(alone) / 1e6, median(parts) / 1e6, median(raw_ratio), median(np_ratio),
                median(np_parts_ratio));
    std::fflush(stdout);
    return {{"frame_bytes", 4 * frame_samples},   {"raw_bytes_per_s", median(raw)},
            {"np_bytes_per_s", median(np)},       {"plain_bytes_per_s", median(alone)},
            {"parts_bytes_per_s", median(parts)}, {"raw_over_plain", median(raw_ratio)},
            {"np_over_plain", median(np_ratio)},  {"np_over_parts", median(np_parts_ratio)}};
}

}  // namespace

int main(int argc, char** argv) {
    try {
        const bench::Arguments arguments(argc, argv);
        const double seconds = arguments.words.empty() ? 2 : std::stod(arguments.words[0]);
        std::printf("%10s %12s %12s %12s %12s %8s %8s %8s\n", "bytes", "raw MB/s", "np MB/s", "plain MB/s",
                    "parts MB/s", "raw", "np", "np/parts");
        Json rows = Json::array();
        for (const std::int64_t samples : {64, 256, 1024, 4096, 16384, 65536}) {
            rows.push_back(compare(samples, seconds));
        }
        arguments.save(rows);
        return 0;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "bench_throughput: %s\n", error.what());
        return 1;
    }
}
