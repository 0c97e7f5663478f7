// hertzline listen: the reference subscriber. Receives one stream, reports losses, and saves the samples.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "apps/arguments/curve_arguments.hpp"
#include "apps/arguments/options.hpp"
#include "apps/command.hpp"
#include "apps/console/output.hpp"
#include "apps/console/progress.hpp"
#include "apps/console/signals.hpp"
#include "core/scene/text.hpp"
#include "measures/tap_names.hpp"
#include "recordings/columns.hpp"
#include "recordings/recording_formats.hpp"
#include "recordings/recording_set.hpp"
#include "stream/listening/listener.hpp"
#include "stream/listening/run_receiver.hpp"
#include "stream/threads.hpp"
#include "stream/wire/endpoint.hpp"

namespace hertzline::app {

namespace {

using std::chrono::steady_clock;

constexpr const char* listen_examples =
    "Missing samples are reported, not filled in; the exit status is then 1.\n"
    "Examples:\n"
    "  hertzline listen\n"
    "  hertzline listen --stream v_last --duration 1e-3 -o last.csv\n"
    "  hertzline listen --connect ipc:///tmp/hertzline --timeout 10 --json";

/// The part of a run that is received; all of it where neither is set.
struct Length {
    std::optional<double> duration_s;  ///< simulated
    std::optional<std::int64_t> samples;

    std::optional<double> samples_at(double fs) const {
        return duration_s ? std::max(1.0, std::round(*duration_s * fs)) : std::optional<double>(samples);
    }
};

struct ListenOptions {
    std::string endpoint = "tcp://127.0.0.1:5573";
    CurveClientRequest curve;
    std::string stream = "v_out";
    Length length;
    std::optional<double> timeout_s;
    std::vector<std::string> files;
    std::optional<double> wav_scale;
    Format format = Format::text;
};

/// Where samples are saved.
struct RecordingRequest {
    std::vector<std::string> files;
    double full_scale = 1;  ///< of WAV files
};

/// Saves one run, and sums it up.
class ListenSession {
public:
    /// @param run the receiver of the frames @param length the part of it that is kept
    ListenSession(stream::RunReceiver& run, const Length& length, RecordingRequest request,
                  stream::RunReceiver::Notify notify);

    /// Takes the next frame, and ends the run when it has lasted long enough.
    /// @throws std::runtime_error when the first samples come and a recording cannot be begun
    void take(const stream::ReceivedFrame& frame);

    /// Completes the recordings.
    void save();

    /// Whether no recording has failed.
    bool saved() const noexcept { return !recordings_ || recordings_->complete(); }

    double simulated_s() const noexcept {
        return run_.has_samples() ? static_cast<double>(samples_) / run_.fs() : 0;
    }

    Json summary() const;

private:
    void begin();

    stream::RunReceiver& run_;
    Length length_;
    RecordingRequest request_;
    stream::RunReceiver::Notify notify_;
    std::optional<recordings::RecordingSet> recordings_;  // from the first frame on
    std::uint64_t samples_ = 0;                           // kept
};

ListenSession::ListenSession(stream::RunReceiver& run, const Length& length, RecordingRequest request,
                             stream::RunReceiver::Notify notify)
    : run_(run), length_(length), request_(std::move(request)), notify_(std::move(notify)) {}

void ListenSession::begin() {
    recordings::RecordingHead head{.columns = {},
                                   .sample_rate_hz = run_.fs(),
                                   .numbers = recordings::NumberType::float32,
                                   .provenance = run_.provenance(),
                                   .full_scale = request_.full_scale};
    if (!request_.files.empty()) {
        head.columns = recordings::recorded_columns(run_.tap(), counts_of(run_.tap(), run_.channels()));
    }
    recordings_.emplace(request_.files, head, recordings::RecordingPatience::of_a_second(stop_asked()),
                        notify_);
}

void ListenSession::take(const stream::ReceivedFrame& frame) {
    if (!recordings_) {
        begin();
    }
    for (const Json& change : run_.take_changes()) {
        recordings_->note_change(change);
    }
    std::size_t count = frame.header.n;
    if (const auto wanted = length_.samples_at(run_.fs())) {
        const double left = *wanted - static_cast<double>(samples_);
        if (left <= static_cast<double>(count)) {
            count = static_cast<std::size_t>(left);
            run_.end(stream::EndReason::long_enough);
        }
    }
    if (recordings_->any_left()) {
        const auto end = frame.values.begin() + static_cast<std::ptrdiff_t>(count * run_.channels());
        recordings_->write(static_cast<std::int64_t>(frame.header.sample), {frame.values.begin(), end});
    }
    samples_ += count;
}

void ListenSession::save() {
    if (recordings_) {
        recordings_->commit();
        for (const std::string& text : recordings_->warnings()) {
            notify_(text);
        }
    }
}

Json ListenSession::summary() const {
    Json summary;
    summary["stream"] = row_of(run_.tap()).name;
    summary["run"] = run_.run();
    summary["fs"] = run_.fs();
    summary["channels"] = run_.channels();
    summary["first_sample"] = run_.first_sample();
    summary["simulated_s"] = simulated_s();
    summary["samples"] = samples_;
    summary.update(run_.account());
    summary["recordings"] = recordings_ ? recordings::recordings_json(recordings_->status()) : Json::array();
    summary["gapless"] = run_.complete();
    summary["ended_by"] = word(run_.end_reason());
    return summary;
}

/// The tap and the keys that the options name.
struct Wanted {
    Tap tap{};
    std::optional<stream::CurveClient> curve;
};

/// @throws WrongUse that names every fault
Wanted checked(const ListenOptions& options) {
    Faults faults;
    faults.add("--connect", stream::endpoint_fault(options.endpoint, stream::EndpointUse::connect));
    const auto tap = faults.value_of("--stream", measures::find_tap(options.stream, streamed_taps));
    faults.add("--duration", positive_fault(options.length.duration_s));
    faults.add("--samples", positive_fault(options.length.samples));
    if (options.length.duration_s && options.length.samples) {
        faults.add("--samples: found --duration, too, allowed: one of them");
    }
    faults.add("--timeout", positive_fault(options.timeout_s));
    check_recordings(options.files, faults);
    check_wav_scale(options.wav_scale, options.files, faults);
    const auto curve = curve_of(options.curve, faults);
    faults.refuse<WrongUse>();
    return {*tap, curve};
}

void listen_to_the_end(stream::Listener& listener, ListenSession& session, ProgressLine& line,
                       const ListenOptions& options) {
    const stream::ShortSlices prompt;
    constexpr auto nap = std::chrono::milliseconds(100);  // between looks at the stop flag
    constexpr auto patience = std::chrono::seconds(2);
    const std::atomic<bool>& stop = stop_asked();
    const steady_clock::time_point start = steady_clock::now();
    const std::string waiting = "waiting for " + options.stream + " from " + options.endpoint;
    bool told = line.is_on_terminal();  // again and again
    while (!listener.ended()) {
        if (const stream::ReceivedFrame* frame = listener.receive(nap)) {
            session.take(*frame);
        }
        if (stop) {
            listener.end(stream::EndReason::stopped);
        }
        if (!told && !listener.run().has_samples() && steady_clock::now() - start > patience) {
            told = true;
            spdlog::info(waiting);
        }
        if (line.due()) {
            const double passed_s = std::chrono::duration<double>(steady_clock::now() - start).count();
            line.show(listener.run().has_samples()
                          ? progress_text({session.simulated_s(), options.length.duration_s, passed_s})
                          : waiting);
        }
    }
}

/// Reports faults of the run, after everything was saved.
void report_faults(const stream::Listener& listener, const ListenOptions& options) {
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
    ListenSession session(listener.run(), options.length, {options.files, options.wav_scale.value_or(1)},
                          notify);
    listen_to_the_end(listener, session, line, options);
    line.clear();

    session.save();
    if (listener.run().has_samples() || options.format == Format::json) {
        Json summary = session.summary();
        summary["endpoint"] = options.endpoint;
        print_summary(summary, options.format);
    }
    report_faults(listener, options);
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
        ->type_name("STREAM")
        ->capture_default_str();
    app.add_option("--duration", options->length.duration_s,
                   "simulated seconds to receive (default: to the end)")
        ->type_name("S");
    app.add_option("--samples", options->length.samples, "the same in samples")->type_name("N");
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
    app.footer(listen_examples);
    return [options] { return listen(*options); };
}

}  // namespace hertzline::app
