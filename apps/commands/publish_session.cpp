#include "apps/commands/publish_session.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <sys/resource.h>

#include "apps/allocator.hpp"
#include "apps/arguments/options.hpp"
#include "apps/console/signals.hpp"
#include "core/scene/text.hpp"
#include "measures/resources.hpp"
#include "measures/tap_names.hpp"
#include "stream/pipeline/capacity.hpp"
#include "stream/pipeline/stream_messages.hpp"
#include "stream/wire/endpoint.hpp"

namespace hertzline::app {

namespace {

std::optional<std::int64_t> samples_of(std::optional<double> duration_s, double sample_rate_hz) {
    if (!duration_s) {
        return std::nullopt;
    }
    constexpr double max_samples = 9e18;  // within 63 bits
    const double samples = std::round(*duration_s * sample_rate_hz);
    if (samples > max_samples) {
        throw WrongUse(
            fmt::format("--duration: found {} s, which is {:.3g} samples, allowed: at most {:.0e} samples",
                        *duration_s, samples, max_samples));
    }
    return static_cast<std::int64_t>(std::max(1.0, samples));
}

/// Returns the most connections that leave enough descriptors for files and for ZeroMQ.
int most_clients() {
    constexpr rlim_t others = 40;
    rlimit descriptors{};
    getrlimit(RLIMIT_NOFILE, &descriptors);
    return static_cast<int>(std::clamp<rlim_t>(descriptors.rlim_cur, others + 1, 1 << 20) - others);
}

void announce(const stream::Publisher& publisher, const stream::Pipeline& pipeline) {
    spdlog::info("endpoint {}", publisher.endpoint());
    spdlog::info("streams {}, float32 at {:g} Hz; meta, meters, end",
                 comma_separated(measures::names_of(pipeline.format().taps)),
                 pipeline.format().sample_rate_hz);
    spdlog::info("run {}", pipeline.options().run);
    const bool encrypted = publisher.security() == stream::Security::curve;
    spdlog::info("to listen: hertzline listen --connect {}{}", local_endpoint(publisher.endpoint()),
                 encrypted ? " --curve-key YOURS.key_secret --server-key OURS.key" : "");
    if (pipeline.options().start == stream::StreamStart::with_first_subscriber) {
        spdlog::info("waiting for a subscriber");
    }
}

std::string progress_of(const stream::StreamMeters& meters, const stream::Pipeline& pipeline) {
    std::optional<double> goal_s;
    if (pipeline.options().samples) {
        goal_s = static_cast<double>(*pipeline.options().samples) / pipeline.format().sample_rate_hz;
    }
    return fmt::format("{}, load {:.0f} %, {} late, {} dropped",
                       progress_text({meters.simulated_s, goal_s, meters.wall_s}), 100 * meters.load,
                       meters.late_frames, meters.dropped_frames);
}

/// Drops the counts of topics that had no subscriber.
Json without_unused_topics(Json summary) {
    for (auto member = summary.begin(); member != summary.end();) {
        const std::string& name = member.key();
        const bool of_topic = name.ends_with("_sent") || name.ends_with("_dropped");
        member = of_topic && *member == 0 ? summary.erase(member) : std::next(member);
    }
    return summary;
}

}  // namespace

std::string local_endpoint(std::string endpoint) {
    constexpr std::string_view every_interface = "//0.0.0.0:";
    if (const std::size_t at = endpoint.find(every_interface); at != std::string::npos) {
        endpoint.replace(at, every_interface.size(), "//127.0.0.1:");
    }
    return endpoint;
}

namespace {

/// Whether the text is a number of bytes with a unit of CLI11 or none.
bool is_size(std::string_view text) {
    const std::size_t end = std::min(text.find_first_not_of("0123456789"), text.size());
    std::string unit = lower_case(trimmed(text.substr(end), " "));
    if (unit.ends_with('b')) {
        unit.pop_back();
    }
    if (unit.size() == 2 && unit.ends_with('i')) {
        unit.pop_back();
    }
    return end > 0 && (unit.empty() ||
                       (unit.size() == 1 && std::string_view("kmgtpe").find(unit) != std::string_view::npos));
}

}  // namespace

void add_publish_options(CLI::App& app, PublishRequest& request, const std::string& usual_on_overrun) {
    const std::map<std::string, stream::OnOverrun> on_overrun_words{{"drop", stream::OnOverrun::drop},
                                                                    {"wait", stream::OnOverrun::wait}};
    std::vector<std::string> words;
    std::ranges::transform(on_overrun_words, std::back_inserter(words),
                           [](const auto& row) { return row.first; });
    app.add_option("--bind", request.endpoint, "where to publish: tcp://HOST:PORT or ipc://PATH")
        ->type_name("ENDPOINT")
        ->capture_default_str();
    add_curve_options(app, request.curve);
    app.add_option("--pace", request.pace, "realtime, flat-out, or simulated seconds per second")
        ->type_name("PACE")
        ->capture_default_str();
    app.add_option("--duration", request.duration_s,
                   "simulated seconds (default: until stopped, or until a recording ends)")
        ->type_name("S");
    app.add_flag_callback(
        "--wait-for-subscriber", [&request] { request.start = stream::StreamStart::with_first_subscriber; },
        "hold back sample 0 until a stream has a subscriber");
    app.add_option("--on-overrun", request.on_overrun,
                   "treatment of a frame whose time has passed while the program was held up: drop it and "
                   "count it, or wait and fall behind (default: " +
                       usual_on_overrun + ")")
        ->transform(CLI::CheckedTransformer(on_overrun_words).description(""))
        ->transform(CLI::Validator(  // runs before the other, whose message is another
            [words](std::string& text) {
                return std::ranges::find(words, text) != words.end()
                           ? std::string()
                           : fmt::format("found {}, allowed: {}", text, comma_separated(words));
            },
            ""))
        ->type_name("drop|wait");
    app.add_option("--queue-memory", request.queue_bytes,
                   "memory for the queues of all slow subscribers together, such as 200MiB (default: an "
                   "eighth of the available memory, at most 1GiB)")
        ->transform(CLI::AsSizeValue(/*kb_is_1000=*/false).description(""))
        ->transform(CLI::Validator(  // runs before the other, which wraps such numbers
            [](std::string& text) {
                return is_size(text) ? std::string()
                                     : "found " + text + ", allowed: more than 0, as 200MiB or 1GiB";
            },
            ""))
        ->type_name("BYTES");
    app.add_option(
           "--max-clients", request.max_clients,
           "connections at a time (default: 64); at the limit those without a subscription are closed first")
        ->type_name("N");
    app.add_flag("--realtime-priority", request.thread.realtime_priority,
                 "run the simulating thread with real-time priority, and keep memory from being swapped");
    app.add_option("--cpu", request.thread.cpu, "run the simulating thread on this processor only")
        ->type_name("N");
    add_format_option(app, request.format, "print the summary as one JSON object");
}

std::optional<stream::CurveServer> checked_curve(const PublishRequest& request, Faults& faults) {
    const auto fault = stream::endpoint_fault(request.endpoint, stream::EndpointUse::bind);
    faults.add("--bind", fault);
    if (!fault) {
        check_exposure(request.curve, request.endpoint, faults);
    }
    auto curve = curve_of(request.curve, faults);
    faults.add("--duration", positive_fault(request.duration_s));
    faults.value_of("--pace", stream::parse_pace(request.pace));
    if (request.max_clients && (*request.max_clients < 1 || *request.max_clients > most_clients())) {
        faults.add("--max-clients",
                   fmt::format("found {}, allowed: 1 to {}, of the descriptors that this process may have",
                               *request.max_clients, most_clients()));
    }
    if (request.queue_bytes == 0U) {
        faults.add("--queue-memory: found 0, allowed: more");
    }
    faults.add("--cpu", request.thread.cpu ? stream::cpu_fault(*request.thread.cpu) : std::nullopt);
    return curve;
}

stream::StreamOptions stream_options(const PublishRequest& request, double sample_rate_hz,
                                     stream::OnOverrun on_overrun) {
    return {.about = Json::object(),
            .pace = *stream::parse_pace(request.pace),
            .samples = samples_of(request.duration_s, sample_rate_hz),
            .start = request.start,
            .on_overrun = request.on_overrun.value_or(on_overrun),
            .thread = request.thread};
}

stream::PublisherOptions publisher_options(const PublishRequest& request, const stream::StreamFormat& format,
                                           std::optional<stream::CurveServer> curve) {
    stream::PublisherOptions options;
    options.queue_bytes = request.queue_bytes ? static_cast<double>(*request.queue_bytes)
                                              : stream::usual_queue_bytes(measures::available_memory_bytes());
    options.max_clients = request.max_clients.value_or(std::min(options.max_clients, most_clients()));
    options.largest_message = stream::largest_frame_bytes(format);
    options.curve = std::move(curve);
    return options;
}

double stream_bytes(const stream::StreamFormat& format, stream::Pace pace,
                    const stream::PublisherOptions& options) noexcept {
    return stream::ring_bytes(format, pace) + stream::most_queued_bytes(options);
}

void publish_to_the_end(stream::Pipeline& pipeline, const stream::Publisher& publisher, ProgressLine& line,
                        Format format, const PublishedSource& source) {
    start_allocator_thread();
    announce(publisher, pipeline);
    Json summary;
    bool is_late = false;
    const auto warn_of_lateness = [&](const stream::StreamMeters& meters) {
        if (!is_late && meters.largest_lateness_s > stream::too_late_s) {
            is_late = true;
            line.clear();
            spdlog::warn(stream::lateness_text(meters));
        }
    };
    pipeline.run(stop_asked(), {.progress =
                                    [&](const stream::StreamMeters& meters) {
                                        warn_of_lateness(meters);
                                        if (line.due()) {
                                            line.show(progress_of(meters, pipeline));
                                        }
                                    },
                                .warn =
                                    [&](const std::string& text) {
                                        line.clear();
                                        spdlog::warn(text);
                                    },
                                .starts = source.starts,
                                .epoch_begins = source.epoch_begins,
                                .watch = source.watch,
                                .summary =
                                    [&](const stream::StreamMeters& meters) {
                                        summary = stream::summary_json(meters, pipeline, publisher);
                                        source.add_to_summary(summary, meters);
                                        return json_text(summary);
                                    }});
    line.clear();
    summary["samples"] =
        summary.value("samples", source.first_sample) - source.first_sample;  // an index until here
    print_summary(format == Format::text ? without_unused_topics(std::move(summary)) : summary, format);
}

}  // namespace hertzline::app
