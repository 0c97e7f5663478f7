// hertzline listen: the reference subscriber. Says whether everything arrived, and saves it.

#include <chrono>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "apps/arguments/curve_arguments.hpp"
#include "apps/command.hpp"
#include "apps/commands/listen_session.hpp"
#include "apps/commands/preflight.hpp"
#include "apps/console/output.hpp"
#include "apps/console/progress.hpp"
#include "apps/console/signals.hpp"
#include "core/scene/text.hpp"
#include "stream/recordings/recording_formats.hpp"
#include "stream/wire/endpoint.hpp"
#include "stream/wire/topics.hpp"

namespace hertzline::app {

namespace {

using std::chrono::steady_clock;

constexpr const char* examples =
    "Samples that were missed are reported, not filled in; the exit status is 1 when anything was.\n"
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
    Format format = Format::text;
};

Tap tap_of(const ListenOptions& options) {
    if (const auto tap = tap_named(options.stream)) {
        return *tap;
    }
    std::vector<std::string> names;
    for (const Tap tap : streamed_taps(EndKind::plate)) {
        names.emplace_back(row_of(tap).name);
    }
    throw WrongUse(fmt::format("--stream: found {}, allowed: {}{}", quoted_briefly(options.stream),
                               comma_separated(names), suggestion(options.stream, names)));
}

void refuse_wrong_use(const ListenOptions& options) {
    if (const auto fault = stream::endpoint_fault(options.endpoint, stream::EndpointUse::connect)) {
        throw WrongUse("--connect: " + *fault);
    }
    if (options.duration_s) {
        require_positive("--duration", *options.duration_s);
    }
    if (options.timeout_s) {
        require_positive("--timeout", *options.timeout_s);
    }
    refuse_wrong_files(options.files);
}

/// How long a silence may last [s]. A stream that runs sends its meta once a second, so one that was heard
/// and falls silent is gone: it was killed, or its end was lost in a full queue. As long as
/// stream/subscriber takes to notice that a machine is gone.
double patience(const Listening& listening, const ListenOptions& options) {
    constexpr double for_a_stream_that_was_heard = 15;
    constexpr double for_one_to_come = std::numeric_limits<double>::infinity();
    return options.timeout_s.value_or(listening.heard_samples() ? for_a_stream_that_was_heard
                                                                : for_one_to_come);
}

void listen_to_the_end(stream::Subscriber& subscriber, Listening& listening, ProgressLine& line,
                       const ListenOptions& options) {
    constexpr auto nap = std::chrono::milliseconds(100);  // between looks at the clock and the stop flag
    const std::atomic<bool>& stop = stop_asked();
    const steady_clock::time_point start = steady_clock::now();
    steady_clock::time_point last_heard = start;
    const auto seconds_since = [](steady_clock::time_point then) {
        return std::chrono::duration<double>(steady_clock::now() - then).count();
    };
    while (listening.ending() == Ending::none) {
        const stream::Message* message = subscriber.receive(nap);
        if (message != nullptr) {
            const bool knew_the_run = listening.knows_the_run();
            listening.take(*message);
            last_heard = steady_clock::now();
            if (listening.knows_the_run() && !knew_the_run) {
                // Only now: the first frame shall find us knowing where it comes from.
                subscriber.subscribe(listening.topic());
            }
        } else if (seconds_since(last_heard) > patience(listening, options)) {
            listening.end(Ending::silence);
        }
        if (const auto refusal = subscriber.refusal()) {
            listening.note_refusal(*refusal);
        }
        if (stop && listening.ending() == Ending::none) {
            listening.end(Ending::stopped);
        }
        if (line.due()) {
            line.show(listening.heard_samples()
                          ? progress_text({listening.simulated_s(), options.duration_s, seconds_since(start)})
                          : "waiting for " + options.stream + " from " + options.endpoint);
        }
    }
}

/// What was wrong, after everything was saved.
void complain(const Listening& listening, const ListenOptions& options) {
    if (listening.ending() == Ending::silence) {
        spdlog::error("nothing arrived for {} s from {}", number_text(patience(listening, options)),
                      options.endpoint);
    }
    if (!listening.heard_samples()) {
        spdlog::error("no samples of {} were received", options.stream);
    } else if (!listening.sound()) {
        spdlog::error("the stream is not unbroken: {}", listening.text());
    }
}

Exit listen(const ListenOptions& options) {
    refuse_wrong_use(options);
    const Tap tap = tap_of(options);
    const stream::SubscriberOptions subscriber_options{.curve = curve_of(options.curve)};
    stop_asked();
    for (const std::string& file : options.files) {
        stream::require_writable(file);
    }
    ProgressLine line;
    Listening listening(tap, options.duration_s, options.files, [&line](const std::string& text) {
        line.clear();
        spdlog::warn(text);
    });
    stream::Subscriber subscriber(options.endpoint, subscriber_options);
    subscriber.subscribe(stream::meta_topic);
    subscriber.subscribe(stream::end_topic);
    listen_to_the_end(subscriber, listening, line, options);
    line.clear();

    listening.save();
    if (listening.heard_samples() || options.format == Format::json) {
        Json summary = listening.summary();
        summary["endpoint"] = options.endpoint;
        print_summary(summary, options.format);
    }
    complain(listening, options);
    return listening.sound() && listening.saved() ? Exit::done : Exit::failed;
}

}  // namespace

Command listen_command(CLI::App& program) {
    auto options = std::make_shared<ListenOptions>();
    CLI::App* command =
        program.add_subcommand("listen", "receive a stream, check that nothing is missing, save it");
    command->add_option("--connect", options->endpoint, "where a stream is published")
        ->type_name("ENDPOINT")
        ->capture_default_str();
    add_curve_options(*command, options->curve);
    command->add_option("--stream", options->stream, "v_out, v_last, v_plate or v_chain")
        ->type_name("NAME")
        ->capture_default_str();
    command
        ->add_option("--duration", options->duration_s, "simulated seconds to receive (default: to the end)")
        ->type_name("S");
    add_repeatable_option(
        *command, "-o,--output", options->files,
        "save the samples; the ending picks the format: " + stream::recording_endings() + "; repeatable")
        ->check(missing_name)
        ->type_name("FILE");
    command
        ->add_option(
            "--timeout", options->timeout_s,
            "give up when nothing arrives for S seconds (default: 15 once samples came, never before)")
        ->type_name("S");
    add_format_option(*command, options->format, "print the summary as one JSON object");
    command->footer(examples);
    return {command, [options] { return listen(*options); }};
}

}  // namespace hertzline::app
