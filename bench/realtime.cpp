// Does a real-time stream keep pace, and does a listener that keeps up get every sample?
//
//     bench_realtime [SECONDS [STREAMS...]]        60 s with 1 and with 4 streams by default
//
// The program streams paper-stream from one core. The listener, on another core, keeps a fingerprint of every
// frame; when the stream has ended it simulates the same scene itself and compares: every float32 must be
// what `hertzline run` writes.

#include <array>
#include <cstdio>
#include <cstring>
#include <iostream>
#include <map>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include <fcntl.h>
#include <sched.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/numerics.hpp"
#include "core/scene_toml.hpp"
#include "core/shipped_scenes.hpp"
#include "core/simulation.hpp"
#include "stream/continuity.hpp"
#include "stream/frame_codec.hpp"
#include "stream/subscriber.hpp"
#include "stream/taps.hpp"

namespace {

using namespace hertzline;

constexpr const char* scene_name = "paper-stream";
constexpr const char* endpoint = "tcp://127.0.0.1:5599";

void stay_on_core(int core) {
    cpu_set_t set;
    CPU_ZERO(&set);
    CPU_SET(core, &set);
    if (sched_setaffinity(0, sizeof set, &set) != 0) {
        std::perror("sched_setaffinity");
    }
}

/// `hertzline stream` on core 0; its summary comes through the pipe.
struct Program {
    pid_t pid = 0;
    int summary = -1;

    explicit Program(const std::string& seconds) {
        int ends[2];
        if (pipe(ends) != 0) {
            throw std::runtime_error("no pipe");
        }
        pid = fork();
        if (pid == 0) {
            stay_on_core(0);
            dup2(ends[1], STDOUT_FILENO);
            dup2(open("/dev/null", O_WRONLY), STDERR_FILENO);
            execl(HERTZLINE_PROGRAM, "hertzline", "stream", scene_name, "--bind", endpoint, "--duration",
                  seconds.c_str(), "--wait-for-subscriber", "--json", nullptr);
            _exit(127);
        }
        close(ends[1]);
        summary = ends[0];
    }

    std::string result() const {
        std::string text;
        char buffer[4096];
        for (ssize_t n = 0; (n = read(summary, buffer, sizeof buffer)) > 0;) {
            text.append(buffer, static_cast<std::size_t>(n));
        }
        waitpid(pid, nullptr, 0);
        return text;
    }
};

Scene streamed_scene() {
    return resolved(*parse_scene(find_shipped_scene(scene_name)->text, scene_name).scene).scene;
}

const std::vector<double>& column(const Samples& samples, Tap tap) {
    switch (tap) {
        case Tap::v_out:
            return samples.v_out;
        case Tap::v_last:
            return samples.v_last;
        case Tap::v_plate:
            return samples.v_plate;
        case Tap::v_chain:
            break;
    }
    return samples.chain_v;
}

/// 64 bits of a frame's bytes; four lanes of multiply and shift, so that listening stays cheap.
std::uint64_t fingerprint(std::span<const std::byte> bytes) {
    std::array<std::uint64_t, 4> lanes{1, 2, 3, 4};
    const auto mix = [](std::uint64_t lane, std::uint64_t word) {
        lane = (lane ^ word) * 0x9e3779b97f4a7c15U;
        return lane ^ (lane >> 29U);
    };
    std::size_t at = 0;
    for (; at + 32 <= bytes.size(); at += 32) {
        std::array<std::uint64_t, 4> words{};
        std::memcpy(words.data(), bytes.data() + at, 32);
        for (std::size_t i = 0; i < 4; ++i) {
            lanes[i] = mix(lanes[i], words[i]);
        }
    }
    for (; at < bytes.size(); ++at) {
        lanes[0] = mix(lanes[0], static_cast<std::uint64_t>(bytes[at]));
    }
    return mix(mix(lanes[0], lanes[1]), mix(lanes[2], lanes[3]));
}

struct ReceivedFrame {
    std::uint64_t sample;
    std::uint64_t fingerprint;
    std::uint32_t samples;
    Tap tap;
};

struct Heard {
    std::vector<ReceivedFrame> frames;
    std::map<Tap, ContinuityCheck> checks;
    bool ended = false;
};

/// Listens until the end of the run, or until nothing has come for a while (the end itself may have been
/// lost).
Heard hear(Subscriber& subscriber, std::size_t streams) {
    std::map<std::string, Tap, std::less<>> taps;
    for (std::size_t i = 0; i < streams; ++i) {
        const std::string topic(names_of(all_taps[i]).np_topic);
        taps[topic] = all_taps[i];
        subscriber.subscribe(topic);
    }
    subscriber.subscribe(end_topic);
    Heard heard;
    while (const Message* message = subscriber.receive(std::chrono::seconds(10))) {
        if (message->topic() == end_topic) {
            heard.ended = true;
            break;
        }
        const Tap tap = taps.find(message->topic())->second;
        const auto header = decode_header(message->text(0), message->bytes(1).size());
        if (!header) {
            throw std::runtime_error("a bad frame: " + header.error());
        }
        heard.checks[tap].take(*header);
        heard.frames.push_back(
            {header->sample, fingerprint(message->bytes(1)), static_cast<std::uint32_t>(header->n), tap});
    }
    return heard;
}

/// Frames that are not what the simulation gives here.
std::uint64_t differing(const Scene& scene, const std::vector<ReceivedFrame>& frames, Wish wish) {
    Simulation simulation(scene, wish);
    Samples samples(simulation.chain(), static_cast<std::size_t>(scene.output.frame_samples), wish);
    std::vector<float> values;
    std::uint64_t wrong = 0;
    for (const ReceivedFrame& frame : frames) {
        const auto sample = static_cast<std::int64_t>(frame.sample);
        if (samples.first != sample || samples.count != frame.samples) {
            simulation.skip(sample - simulation.next_sample());
            simulation.advance(samples, frame.samples, wish);
        }
        const std::vector<double>& expected = column(samples, frame.tap);
        const std::size_t width = frame.tap == Tap::v_chain ? samples.spheres : 1;
        values.assign(expected.begin(),
                      expected.begin() + static_cast<std::ptrdiff_t>(width * frame.samples));
        wrong += fingerprint(std::as_bytes(std::span(values))) == frame.fingerprint ? 0 : 1;
    }
    return wrong;
}

void listen(const std::string& seconds, std::size_t streams) {
    const Scene scene = streamed_scene();
    const Program program(seconds);
    Subscriber subscriber(endpoint, {.receive_high_water_mark = 1 << 17});
    const Heard heard = hear(subscriber, streams);
    std::uint64_t missing = 0;
    std::uint64_t samples = 0;
    for (const auto& [tap, check] : heard.checks) {
        missing += check.totals().missing_samples;
        samples += check.totals().samples;
    }
    const std::string summary = program.result();
    const bool chain = streams == all_taps.size();
    const std::uint64_t wrong = differing(
        scene, heard.frames, {.outputs = true, .chain_velocities = chain, .chain_displacements = false});
    std::cout << "{\"streams\": " << streams << ", \"samples_received\": " << samples
              << ", \"samples_missing\": " << missing << ", \"frames_compared\": " << heard.frames.size()
              << ", \"frames_that_differ\": " << wrong
              << ", \"end_heard\": " << (heard.ended ? "true" : "false") << ",\n \"program\": " << summary
              << "}" << std::endl;
}

}  // namespace

int main(int argc, char** argv) {
    try {
        stay_on_core(1);
        const std::string seconds = argc > 1 ? argv[1] : "60";
        std::vector<std::size_t> counts;
        for (int i = 2; i < argc; ++i) {
            counts.push_back(std::stoul(argv[i]));
        }
        for (const std::size_t streams : counts.empty() ? std::vector<std::size_t>{1, 4} : counts) {
            listen(seconds, streams);
        }
        return 0;
    } catch (const std::exception& error) {
        std::cerr << "bench_realtime: " << error.what() << '\n';
        return 1;
    }
}
