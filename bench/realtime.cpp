// Does a real-time stream keep pace, and does a listener that keeps up get every sample?
//
//     bench_realtime [SECONDS [STREAMS...]]        60 s with 1 and with 4 streams by default
//
// The program streams paper-stream from one core. The listener, on another core, simulates the same scene
// itself and compares every float32 that arrives with its own, bit for bit: what `hertzline run` would write.

#include <bit>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <map>
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

/// The same samples, made here.
class Oracle {
public:
    Oracle(const Scene& scene, Wish wish)
        : simulation_(scene, wish),
          samples_(simulation_.chain(), static_cast<std::size_t>(scene.output.frame_samples), wish),
          wish_(wish) {}

    /// Samples of the frame that starts at `sample` and has n of them.
    const Samples& frame(std::uint64_t sample, std::size_t n) {
        if (samples_.first != static_cast<std::int64_t>(sample) || samples_.count != n) {
            simulation_.skip(static_cast<std::int64_t>(sample) - simulation_.next_sample());
            simulation_.advance(samples_, n, wish_);
        }
        return samples_;
    }

private:
    Simulation simulation_;
    Samples samples_;
    Wish wish_;
};

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

std::uint64_t differing(const std::vector<float>& received, const std::vector<double>& expected) {
    std::uint64_t count = 0;
    for (std::size_t i = 0; i < received.size(); ++i) {
        const auto bits = std::bit_cast<std::uint32_t>(static_cast<float>(expected[i]));
        count += std::bit_cast<std::uint32_t>(received[i]) != bits ? 1 : 0;
    }
    return count;
}

void listen(const std::string& seconds, std::size_t streams) {
    const Scene scene = streamed_scene();
    const bool chain = streams == all_taps.size();
    Oracle oracle(scene, {.outputs = true, .chain_velocities = chain, .chain_displacements = false});
    const Program program(seconds);
    Subscriber subscriber(endpoint, {.receive_high_water_mark = 1 << 17});
    subscriber.subscribe(end_topic);
    std::map<std::string, ContinuityCheck, std::less<>> checks;
    std::map<std::string, Tap, std::less<>> taps;
    for (std::size_t i = 0; i < streams; ++i) {
        const std::string topic(names_of(all_taps[i]).np_topic);
        taps[topic] = all_taps[i];
        checks[topic];
        subscriber.subscribe(topic);
    }

    std::uint64_t values = 0;
    std::uint64_t wrong = 0;
    std::vector<float> received;
    for (;;) {
        const Message* message = subscriber.receive(std::chrono::seconds(30));
        if (message == nullptr) {
            throw std::runtime_error("the stream went silent");
        }
        if (message->topic() == end_topic) {
            break;
        }
        const auto tap = taps.find(message->topic());
        const auto header = decode_header(message->text(0), message->bytes(1).size());
        if (!header || !decode_samples(message->bytes(1), received)) {
            throw std::runtime_error("a bad frame: " + header.error());
        }
        checks.find(message->topic())->second.take(*header);
        values += received.size();
        wrong += differing(received, column(oracle.frame(header->sample, header->n), tap->second));
    }

    std::uint64_t missing = 0;
    std::uint64_t samples = 0;
    for (const auto& [topic, check] : checks) {
        missing += check.totals().missing_samples;
        samples += check.totals().samples;
    }
    std::cout << "{\"streams\": " << streams << ", \"samples_received\": " << samples
              << ", \"values_compared\": " << values << ", \"values_that_differ\": " << wrong
              << ", \"samples_missing\": " << missing << ",\n \"program\": " << program.result() << "}"
              << std::endl;
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
