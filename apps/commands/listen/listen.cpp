// hertzline listen: the reference subscriber. Receives one stream, reports losses, and saves the samples.

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "recordings/recording_formats.hpp"
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "apps/arguments/curve_arguments.hpp"
#include "apps/arguments/options.hpp"
#include "apps/command.hpp"
#include "apps/commands/listen/listen_session.hpp"
#include "apps/commands/preflight.hpp"
#include "apps/console/output.hpp"
#include "apps/console/progress.hpp"
#include "apps/console/signals.hpp"
#include "core/scene/text.hpp"
#include "stream/listening/listener.hpp"
#include "stream/wire/endpoint.hpp"

namespace hertzline::app {

namespace {

using std::chrono::steady_clock;

constexpr const char* examples =
    "Missing samples are reported, not filled in; the exit status is then 1.\n"
    "Examples:\n"
    "  hertzline listen\n"
    "  hertzline listen --stream v_last --duration 1e-3 -o last.csv\n"
    "  hertzline listen --connect ipc:///tmp/hertzline --timeout 10 --json";

struct ListenOptions {
    std::string endpoint = "tcp://127.0.0.1:5573";
    CurveClientRequest curve;
    std::string stream = "v_out";
    std::optional<double> duration_s;
    std::optional<double> timeout_s;
    std::vector<std::string> files;
    std::optional<double> wav_scale;
    Format format = Format::text;
};

Tap tap_of(const ListenOptions& options) {
    return tap_argument("--stream", options.stream, streamed_taps);
}

/// What the options ask for, checked.
struct Wanted {
    Tap tap{};
    std::optional<stream::CurveClient> curve;
};

/// @throws WrongUse that names every fault
Wanted checked(const ListenOptions& options) {
    Faults faults;
    Wanted wanted;
    faults.of([&] {
        if (const auto fault = stream::endpoint_fault(options.endpoint, stream::EndpointUse::connect)) {
            throw WrongUse("--connect: " + *fault);
        }
    });
    faults.of([&] { wanted.tap = tap_of(options); });
    faults.of([&] {
        if (options.duration_s) {
            require_positive("--duration", *options.duration_s);
        }
    });
    faults.of([&] {
        if (options.timeout_s) {
            require_positive("--timeout", *options.timeout_s);
        }
    });
    faults.of([&] { refuse_wrong_files(options.files); });
    faults.of([&] { refuse_wrong_wav_scale(options.wav_scale, options.files); });
    faults.of([&] { wanted.curve = curve_of(options.curve); });
    faults.refuse();
    return wanted;
}

void listen_to_the_end(stream::Listener& listener, ListenSession& session, ProgressLine& line,
                       const ListenOptions& options) {
    constexpr auto nap = std::chrono::milliseconds(100);  // between looks at the stop flag
    const std::atomic<bool>& stop = stop_asked();
    const steady_clock::time_point start = steady_clock::now();
    while (!listener.ended()) {
        if (const stream::ReceivedFrame* frame = listener.receive(nap)) {
            session.take(*frame);
        }
        if (stop) {
            listener.end(stream::EndReason::stopped);
        }
        if (line.due()) {
            const double passed_s = std::chrono::duration<double>(steady_clock::now() - start).count();
            line.show(listener.run().has_samples()
                          ? progress_text({session.simulated_s(), options.duration_s, passed_s})
                          : "waiting for " + options.stream + " from " + options.endpoint);
        }
    }
}

/// Reports faults of the run, after everything was saved.
void complain(const stream::Listener& listener, const ListenOptions& options) {
    const stream::RunReceiver& run = listener.run();
    if (run.end_reason() == stream::EndReason::silence) {
        spdlog::error("nothing arrived for {} s from {}", number_text(listener.timeout_s()),
                      options.endpoint);
    }
    if (!run.has_samples()) {
        spdlog::error("no samples of {} were received", options.stream);
    } else if (!run.complete()) {
        spdlog::error("the stream is incomplete: {}", run.text());
    }
}

Exit listen(const ListenOptions& options) {
    const Wanted wanted = checked(options);
    stop_asked();
    for (const std::string& file : options.files) {
        recordings::require_writable(file);
    }
    ProgressLine line;
    const auto notify = [&line](const std::string& text) {
        line.clear();
        spdlog::warn(text);
    };
    stream::Listener listener(
        options.endpoint,
        {.taps = wanted.tap, .timeout_s = options.timeout_s, .curve = wanted.curve, .notify = notify});
    ListenSession session(listener.run(), options.duration_s, {options.files, options.wav_scale.value_or(1)},
                          notify);
    listen_to_the_end(listener, session, line, options);
    line.clear();

    session.save();
    if (listener.run().has_samples() || options.format == Format::json) {
        Json summary = session.summary();
        summary["endpoint"] = options.endpoint;
        print_summary(summary, options.format);
    }
    complain(listener, options);
    return listener.run().complete() && session.saved() ? Exit::done : Exit::failed;
}

}  // namespace

Run listen_command(CLI::App& app) {
    auto options = std::make_shared<ListenOptions>();
    app.add_option("--connect", options->endpoint, "endpoint of a stream")
        ->type_name("ENDPOINT")
        ->capture_default_str();
    add_curve_options(app, options->curve);
    app.add_option("--stream", options->stream, "the stream's name, as hertzline stream prints it")
        ->type_name("NAME")
        ->capture_default_str();
    app.add_option("--duration", options->duration_s, "simulated seconds to receive (default: to the end)")
        ->type_name("S");
    add_repeatable_option(
        app, "-o,--output", options->files,
        "save the samples; the ending picks the format: " + recordings::recording_endings() + "; repeatable")
        ->check(missing_name)
        ->type_name("FILE");
    add_wav_scale_option(app, options->wav_scale);
    app.add_option(
           "--timeout", options->timeout_s,
           "give up when nothing arrives for S seconds (default: 15 after the first samples, never before)")
        ->type_name("S");
    add_format_option(app, options->format, "print the summary as one JSON object");
    app.footer(examples);
    return [options] { return listen(*options); };
}

}  // namespace hertzline::app
