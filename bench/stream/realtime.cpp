// Measures whether a real-time stream keeps pace, and whether a listener that keeps up receives every sample.
//
//     bench_realtime [SECONDS [CASE...]]        60 s of the cases 1, 4 and 4x3 by default, and of 1 and 4 by the
//                                               symplectic method
//
// A case is a number of streams, or STREAMSxLISTENERS: listeners in processes of their own, each subscribed to all
// streams. The name of a shipped scene applies to the cases after it; the first cases use paper-stream. A single
// listener has a core of its own. "+all" after a case adds a subscriber to every topic that reads all it gets, "+frozen" one that
// reads nothing: bench_realtime 20 1 1+all 1+frozen. The path of another hertzline program applies to the cases after it. A listener keeps a fingerprint of every frame. When the stream has ended it
// simulates the same scene and compares: every float32 must equal that of `hertzline run`. The listener must have
// received each sent frame, or have counted it as missing; other frames are unaccounted for.

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <functional>
#include <iostream>
#include <map>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include <fcntl.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/scene/json.hpp"
#include "hertzline/resolve.hpp"
#include "hertzline/scene_file.hpp"
#include "hertzline/simulation.hpp"
#include "hertzline/taps.hpp"
#include "stream/wire/continuity.hpp"
#include "stream/wire/frame_codec.hpp"
#include "stream/wire/subscriber.hpp"
#include "stream/wire/topics.hpp"

namespace {

using namespace hertzline;
using namespace hertzline::stream;

constexpr const char* endpoint = "tcp://127.0.0.1:5599";

void stay_on_core(int core) {
    cpu_set_t set;
    CPU_ZERO(&set);
    CPU_SET(core, &set);
    if (sched_setaffinity(0, sizeof set, &set) != 0) {
        std::perror("sched_setaffinity");
    }
}

/// A child process and the pipe that it writes to.
class Child {
public:
    /// @param work gets the descriptor to write to, in the child @param core unset: any
    Child(std::optional<int> core, const std::function<void(int)>& work) {
        std::array<int, 2> ends{};
        if (pipe(ends.data()) != 0) {
            throw std::runtime_error("no pipe");
        }
        pid_ = fork();
        if (pid_ == 0) {
            if (core) {
                stay_on_core(*core);
            }
            work(ends[1]);
            _exit(0);
        }
        close(ends[1]);
        output_ = ends[0];
    }

    void kill() const {
        ::kill(pid_, SIGKILL);
        waitpid(pid_, nullptr, 0);
    }

    /// Returns all that the child writes until it ends.
    std::string result() const {
        std::string text;
        char buffer[4096];
        for (ssize_t n = 0; (n = read(output_, buffer, sizeof buffer)) > 0;) {
            text.append(buffer, static_cast<std::size_t>(n));
        }
        close(output_);
        waitpid(pid_, nullptr, 0);
        return text;
    }

private:
    pid_t pid_ = 0;
    int output_ = -1;
};

/// Runs `hertzline stream` in a child, which writes its summary to the pipe.
void stream_for(const std::string& program, const std::string& seconds, const std::string& scene,
                int summary) {
    dup2(summary, STDOUT_FILENO);
    dup2(open("/dev/null", O_WRONLY), STDERR_FILENO);
    execl(program.c_str(), "hertzline", "stream", scene.c_str(), "--bind", endpoint, "--duration",
          seconds.c_str(), "--wait-for-subscriber", "--json", nullptr);
    _exit(127);
}

Scene resolved_scene(const ShippedScene& shipped) {
    return resolve(parse_scene(shipped.text, shipped.name)->scene).scene;
}

/// The streams, in the order of subscription.
constexpr std::array offered{Tap::v_out, Tap::v_last, Tap::v_plate, Tap::v_chain};

/// Returns a 64-bit fingerprint of a frame's bytes: four lanes of multiply and shift, so that listening stays cheap.
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
    std::uint64_t end_frames = 0;  // of each stream, by the end message
};

/// Listens until the end of the run, or until no message has arrived for 10 s (the end message may be lost).
Heard hear(Subscriber& subscriber, std::size_t streams) {
    std::map<std::string, Tap, std::less<>> taps;
    for (std::size_t i = 0; i < streams; ++i) {
        const std::string topic{std::string_view(topics_of(offered[i]).np)};
        taps[topic] = offered[i];
        subscriber.subscribe(topic);
    }
    subscriber.subscribe(end_topic);
    Heard heard;
    while (const Message* message = subscriber.receive(std::chrono::seconds(10))) {
        if (message->topic() == end_topic) {
            const auto end = nlohmann::json::parse(message->text(0));
            heard.ended = true;
            heard.end_frames =
                end.at("frames").get<std::uint64_t>() + end.at("dropped_frames").get<std::uint64_t>();
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

/// Returns the frames that differ from a simulation here.
std::vector<ReceivedFrame> differing(const Scene& scene, const std::vector<ReceivedFrame>& frames) {
    Simulation simulation(scene, {.taps = streamed_taps_of(scene)});
    Samples samples = simulation.make_samples(static_cast<std::size_t>(scene.output.frame_samples));
    std::vector<float> values;
    std::vector<ReceivedFrame> wrong;
    for (const ReceivedFrame& frame : frames) {
        const auto sample = static_cast<std::int64_t>(frame.sample);
        if (samples.first != sample || samples.count != frame.samples) {
            static_cast<void>(simulation.skip(sample - simulation.next_sample()));
            static_cast<void>(simulation.advance(samples, frame.samples));
        }
        const std::span<const double> expected = samples[frame.tap];
        values.assign(expected.begin(), expected.end());
        if (fingerprint(std::as_bytes(std::span(values))) != frame.fingerprint) {
            wrong.push_back(frame);
        }
    }
    return wrong;
}

/// A listener's account of one stream.
struct Account {
    std::uint64_t samples = 0;
    std::uint64_t frames = 0;
    std::uint64_t missing = 0;  ///< frames missing by the numbers of later ones, or by the end message
    std::uint64_t differing = 0;
    bool ended = false;
};
using Accounts = std::array<Account, offered.size()>;

/// Returns the program's count of frames for a stream's topic, dropped ones included.
std::uint64_t sent(const nlohmann::json& summary, Tap tap) {
    const std::string name(row_of(tap).name);
    return summary.at(name + "_np_sent").get<std::uint64_t>() +
           summary.at(name + "_np_dropped").get<std::uint64_t>();
}

Accounts listen(const ShippedScene& scene, std::size_t streams) {
    Subscriber subscriber(endpoint, {.receive_high_water_mark = 1 << 17});
    const Heard heard = hear(subscriber, streams);
    Accounts accounts;
    for (const auto& [tap, check] : heard.checks) {
        Account& account = accounts[static_cast<std::size_t>(tap)];
        account.samples = check.totals().samples;
        account.frames = check.totals().frames;
        account.missing = check.totals().dropped_by_sender + check.totals().lost_on_the_way;
        account.ended = heard.ended;
        if (heard.ended && heard.end_frames > account.frames + account.missing) {
            account.missing = heard.end_frames - account.frames;  // lost before the end
        }
    }
    for (const ReceivedFrame& wrong : differing(resolved_scene(scene), heard.frames)) {
        ++accounts[static_cast<std::size_t>(wrong.tap)].differing;
    }
    return accounts;
}

enum class Greedy { no, reads, frozen };

/// Subscribes to every topic, until the parent ends.
[[noreturn]] void want_everything(Greedy greedy) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    Subscriber subscriber(endpoint);
    subscriber.subscribe("");
    subscriber.receive(std::chrono::seconds(10));
    if (greedy == Greedy::frozen) {
        raise(SIGSTOP);
    }
    while (true) {
        subscriber.receive(std::chrono::seconds(1));
    }
}

/// Runs a listener in a child, which writes its accounts to the pipe.
void tell_accounts(const ShippedScene& scene, std::size_t streams, int result) {
    const Accounts accounts = listen(scene, streams);
    _exit(write(result, &accounts, sizeof accounts) == sizeof accounts ? 0 : 1);
}

Accounts accounts_of(const Child& listener) {
    const std::string bytes = listener.result();
    Accounts accounts;
    if (bytes.size() != sizeof accounts) {
        throw std::runtime_error("a listener failed");
    }
    std::memcpy(&accounts, bytes.data(), sizeof accounts);
    return accounts;
}

Json report(const Accounts& accounts, const nlohmann::json& summary, std::size_t streams) {
    std::uint64_t samples = 0, frames = 0, missing = 0, wrong = 0, unaccounted = 0;
    bool ended = true;
    for (std::size_t i = 0; i < streams; ++i) {
        const Account& account = accounts[i];
        samples += account.samples;
        frames += account.frames;
        missing += account.missing;
        wrong += account.differing;
        ended = ended && account.ended;
        unaccounted += sent(summary, offered[i]) - account.frames - account.missing;
    }
    return {{"samples_received", samples}, {"frames_received", frames}, {"frames_missing", missing},
            {"frames_that_differ", wrong}, {"end_heard", ended},        {"frames_unaccounted", unaccounted}};
}

/// Runs and prints a case. @param words "4", "4x3" or "1+all"
void measure(const std::string& hertzline, const std::string& seconds, const ShippedScene& scene,
             const std::string& words) {
    const Greedy greedy = words.ends_with("+all")      ? Greedy::reads
                          : words.ends_with("+frozen") ? Greedy::frozen
                                                       : Greedy::no;
    const std::size_t streams = std::stoul(words);
    const std::size_t x = words.find('x');
    const std::size_t listeners = x == std::string::npos ? 1 : std::stoul(words.substr(x + 1));
    if (streams < 1 || streams > offered.size()) {
        throw std::runtime_error("found " + words + ", allowed: 1 to 4 streams");
    }
    const auto core = [alone = listeners == 1 && greedy == Greedy::no](int number) {
        return alone ? std::optional(number) : std::nullopt;
    };
    const Child program(
        core(0), [&](int summary) { stream_for(hertzline, seconds, std::string(scene.name), summary); });
    std::vector<Child> all;
    std::optional<Child> everything;
    if (greedy != Greedy::no) {
        everything.emplace(std::nullopt, [&](int /*result*/) { want_everything(greedy); });
    }
    for (std::size_t i = 0; i < listeners; ++i) {
        all.emplace_back(core(1), [&](int result) { tell_accounts(scene, streams, result); });
    }
    const auto summary = Json::parse(program.result());
    if (everything) {
        everything->kill();
    }
    Json heard = Json::array();
    for (const Child& listener : all) {
        heard.push_back(report(accounts_of(listener), summary, streams));
    }
    const Json result{{"case", words},
                      {"scene", scene.name},
                      {"streams", streams},
                      {"listeners", heard},
                      {"program", summary}};
    std::cout << result.dump(1) << std::endl;
}

}  // namespace

int main(int argc, char** argv) {
    try {
        const std::string seconds = argc > 1 ? argv[1] : "60";
        const std::vector<std::string> cases(argv + std::min(argc, 2), argv + argc);
        const ShippedScene* scene = find_shipped_scene("paper-stream");
        std::string program = HERTZLINE_PROGRAM;
        const std::vector<std::string> usual{"1", "4", "4x3", "paper-stream-symplectic", "1", "4"};
        for (const std::string& words : cases.empty() ? usual : cases) {
            if (const ShippedScene* named = find_shipped_scene(words)) {
                scene = named;
            } else if (words.find('/') != std::string::npos) {
                program = words;
            } else {
                measure(program, seconds, *scene, words);
            }
        }
        return 0;
    } catch (const std::exception& error) {
        std::cerr << "bench_realtime: " << error.what() << '\n';
        return 1;
    }
}
