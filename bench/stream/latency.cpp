// Measures how long after a frame's last sample the frame reaches a subscriber.
//
//     bench_latency [--json FILE] [SECONDS]        10 s by default
//
// paper-stream runs in real time, 10 million samples a second, to a subscriber in another process of this machine.
// Sample k ends (k + 1) / fs after the start; both processes read the same monotonic clock. Frames are released every
// half millisecond, which adds a quarter of a millisecond on average.

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <sys/wait.h>
#include <unistd.h>

#include "bench/support/arguments.hpp"
#include "core/scene/json.hpp"
#include "hertzline/resolve.hpp"
#include "hertzline/scene_file.hpp"
#include "measures/resources.hpp"
#include "stream/inputs/simulation_source.hpp"
#include "stream/pipeline/capacity.hpp"
#include "stream/pipeline/pipeline.hpp"
#include "stream/threads.hpp"
#include "stream/wire/frame_codec.hpp"
#include "stream/wire/subscriber.hpp"
#include "stream/wire/topics.hpp"

namespace {

using namespace hertzline;
using namespace hertzline::recordings;
using namespace hertzline::stream;

constexpr const char* scene_name = "paper-stream";

struct Arrival {
    std::uint64_t end;  ///< index of the sample after the frame's last
    Nanoseconds time;
};

/// Records the arrival time of each frame until the end of the run.
std::vector<Arrival> note_arrivals(const std::string& endpoint, Tap tap) {
    const ShortSlices prompt;
    Subscriber subscriber(endpoint, {.receive_high_water_mark = 1 << 17});
    subscriber.subscribe(end_topic);
    subscriber.subscribe(topics_of(tap).np);
    std::vector<Arrival> arrivals;
    while (const Message* message = subscriber.receive(std::chrono::seconds(10))) {
        const Nanoseconds now = MonotonicClock::now();
        if (message->topic() == end_topic) {
            break;
        }
        const auto header = decode_header(message->text(0), message->bytes(1).size());
        if (!header) {
            throw std::runtime_error("a bad frame: " + header.error());
        }
        arrivals.push_back({header->sample + header->n, now});
    }
    return arrivals;
}

/// Writes all bytes to a pipe.
void write_all(int pipe_end, const void* data, std::size_t left) {
    const auto* bytes = static_cast<const char*>(data);
    while (left > 0) {
        const ssize_t written = write(pipe_end, bytes, left);
        if (written < 0) {
            throw std::runtime_error("cannot write to the pipe");
        }
        bytes += written;
        left -= static_cast<std::size_t>(written);
    }
}

std::string read_all(int pipe_end) {
    std::string bytes;
    char buffer[65536];
    for (ssize_t n = 0; (n = read(pipe_end, buffer, sizeof buffer)) > 0;) {
        bytes.append(buffer, static_cast<std::size_t>(n));
    }
    close(pipe_end);
    return bytes;
}

/// A subscriber in a process of its own. It is made before the stream: a later fork would share the ring's pages, and the
/// stream would have to copy each one that it writes to.
class Listening {
public:
    explicit Listening(Tap tap) {
        int to[2], from[2];
        if (pipe(to) != 0 || pipe(from) != 0 || (process_ = fork()) < 0) {
            throw std::runtime_error("no process for the listener");
        }
        if (process_ == 0) {
            close(to[1]);
            close(from[0]);
            const std::vector<Arrival> arrivals = note_arrivals(read_all(to[0]), tap);
            write_all(from[1], arrivals.data(), arrivals.size() * sizeof(Arrival));
            _exit(0);
        }
        close(to[0]);
        close(from[1]);
        endpoint_ = to[1];
        arrivals_ = from[0];
    }

    void connect(const std::string& endpoint) const {
        write_all(endpoint_, endpoint.data(), endpoint.size());
        close(endpoint_);
    }

    /// Waits for the end of the stream.
    std::vector<Arrival> arrivals() const {
        const std::string bytes = read_all(arrivals_);
        waitpid(process_, nullptr, 0);
        std::vector<Arrival> arrivals(bytes.size() / sizeof(Arrival));
        std::copy_n(bytes.data(), arrivals.size() * sizeof(Arrival),
                    reinterpret_cast<char*>(arrivals.data()));
        return arrivals;
    }

private:
    pid_t process_ = 0;
    int endpoint_ = 0;
    int arrivals_ = 0;
};

struct Measured {
    std::vector<Arrival> arrivals;
    Nanoseconds start;
    StreamMeters meters;
};

Measured stream(const Scene& scene, Tap tap, double seconds) {
    const Listening listening(tap);
    SimulationSource source(scene, TapSet());
    Publisher publisher("tcp://127.0.0.1:*", all_topics,
                        {.queue_bytes = usual_queue_bytes(measures::available_memory_bytes()),
                         .largest_message = largest_frame_bytes(source.format())});
    Pipeline pipeline({.about = Json::object(),
                       .samples = static_cast<std::int64_t>(seconds * scene.output.sample_rate_hz),
                       .start = StreamStart::with_first_subscriber},
                      source, publisher, nullptr);
    listening.connect(publisher.endpoint());
    std::vector<Arrival> arrivals;
    std::thread reading([&] { arrivals = listening.arrivals(); });
    const StreamMeters meters = pipeline.run(
        std::atomic<bool>(false), {.progress = [](const StreamMeters&) {},
                                   .warn = [](const std::string&) {},
                                   .summary = [](const StreamMeters&) { return std::string("{}"); }});
    reading.join();
    return {std::move(arrivals), pipeline.start_time(), meters};
}

Json report(const Scene& scene, Tap tap, double seconds) {
    const Measured measured = stream(scene, tap, seconds);
    if (measured.arrivals.empty()) {
        throw std::runtime_error("nothing arrived");
    }
    std::vector<double> latency;
    for (const Arrival& arrival : measured.arrivals) {
        const double over = static_cast<double>(arrival.end) / scene.output.sample_rate_hz;
        latency.push_back(static_cast<double>((arrival.time - measured.start).count()) * 1e-9 - over);
    }
    std::ranges::sort(latency);
    const auto quantile = [&](double q) {
        return latency[static_cast<std::size_t>(q * static_cast<double>(latency.size() - 1))];
    };
    const std::string name(row_of(tap).name);
    std::printf("%-8s %10zu %8lld %10.3f %10.3f %10.3f %10.3f\n", name.c_str(), latency.size(),
                static_cast<long long>(measured.meters.frames) - static_cast<long long>(latency.size()),
                quantile(0) * 1e3, quantile(0.5) * 1e3, quantile(0.99) * 1e3, quantile(1) * 1e3);
    return {{"stream", name},
            {"frames", latency.size()},
            {"p50_s", quantile(0.5)},
            {"p99_s", quantile(0.99)},
            {"max_s", quantile(1)}};
}

}  // namespace

int main(int argc, char** argv) {
    try {
        const bench::Arguments arguments(argc, argv);
        const double seconds = arguments.words.empty() ? 10 : std::stod(arguments.words[0]);
        const Scene scene =
            resolve(parse_scene(find_shipped_scene(scene_name)->text, scene_name)->scene).scene;
        std::printf("%-8s %10s %8s %10s %10s %10s %10s\n", "stream", "frames", "missing", "min/ms", "p50/ms",
                    "p99/ms", "max/ms");
        Json rows = Json::array();
        for (const Tap tap : {Tap::v_out, Tap::v_chain}) {
            rows.push_back(report(scene, tap, seconds));
        }
        arguments.save(rows);
        return 0;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "bench_latency: %s\n", error.what());
        return 1;
    }
}
