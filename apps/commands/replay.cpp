// hertzline replay: publishes a recording as if it were live.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "apps/arguments/options.hpp"
#include "apps/command.hpp"
#include "apps/commands/listed_changes.hpp"
#include "apps/commands/publish_session.hpp"
#include "apps/console/signals.hpp"
#include "core/scene/faults.hpp"
#include "core/scene/scene_json.hpp"
#include "core/scene/text.hpp"
#include "measures/provenance.hpp"
#include "measures/resources.hpp"
#include "recordings/recording_formats.hpp"
#include "stream/inputs/replay_source.hpp"
#include "stream/wire/topics.hpp"

namespace hertzline::app {

namespace {

constexpr const char* replay_examples =
    "The streams are those of hertzline stream that the recording holds. If it holds none, a single "
    "column is streamed as v_out, several as v_chain. Numbers in mm/s become numbers in m/s; those in volts "
    "stay as they are, with a warning. Sample indices are the recording's, with its gaps.\n"
    "Examples:\n"
    "  hertzline replay burst.sigmf-meta\n"
    "  hertzline replay burst.h5 --pace 0.01 --wait-for-subscriber\n"
    "  hertzline replay elsewhere.npy --sample-rate 1e6 --pace flat-out";

struct ReplayOptions {
    std::string file;
    std::optional<double> sample_rate_hz;
    PublishRequest publish;
};

constexpr std::int64_t usual_frame = 1024;
constexpr std::int64_t max_frame = 1 << 20;

/// Returns the frame length of the recorded run, if it is known.
std::int64_t frame_samples(const Json& provenance) {
    const std::int64_t samples =
        OutsideJson(provenance).count("scene/output/frame_samples").value_or(usual_frame);
    return samples >= 1 && samples <= max_frame ? samples : usual_frame;
}

/// Returns the user's rate, else the file's.
double sample_rate(const recordings::RecordingHead& head, const ReplayOptions& arguments) {
    if (arguments.sample_rate_hz) {
        return *arguments.sample_rate_hz;
    }
    if (head.sample_rate_hz == 0) {
        throw WrongUse(arguments.file + " has no sample rate: give --sample-rate");
    }
    return head.sample_rate_hz;
}

/// The scene of a recording, which live changes may have changed on the way.
class RecordedScene {
public:
    explicit RecordedScene(const Json& provenance) : first_(epoch_in(provenance)) {
        if (const Json& changes = OutsideJson(provenance).at("changes"); changes.is_array()) {
            changes_.assign(changes.begin(), changes.end());
            if (const auto scene = scene_of_json(OutsideJson(provenance).at("scene"))) {
                scene_ = *scene;
            }
        }
        change_until(first_);
    }

    /// Makes the changes of meta those before the first sample.
    void add_to(Json& meta) const {
        if (meta.contains("changes")) {
            listed_.add_to(meta);
        }
    }

    /// Returns the members of meta for another epoch, as `stream` has sent them; null where the recording does not tell.
    Json begin(const Epoch& epoch) {
        change_until(epoch.number);
        if (begun_ == 0) {
            return Json::object();
        }
        Json meta{{"scene", scene_ ? scene_json(*scene_) : Json(nullptr)}};
        for (const char* key : {"integrator", "step_s"}) {
            meta[key] = scene_ ? meta["scene"]["numerics"][key] : Json(nullptr);
        }
        for (const char* key : {"scene_hash", "estimated_error", "estimated_over_s"}) {
            meta[key] = OutsideJson(changes_[begun_ - 1]).at(key);
        }
        listed_.add_to(meta);
        return meta;
    }

private:
    static std::int64_t epoch_in(const Json& json) { return OutsideJson(json).count("epoch").value_or(0); }

    void change_until(std::int64_t epoch) {
        for (; begun_ < changes_.size() && epoch_in(changes_[begun_]) <= epoch; ++begun_) {
            const Json& change = changes_[begun_];
            listed_.add(change);
            if (scene_ && epoch_in(change) > first_) {  // else it has the values
                const auto changed = with_values(*scene_, OutsideJson(change).at("set"));
                scene_ = changed ? std::optional(*changed) : std::nullopt;
            }
        }
    }

    std::int64_t first_;  // epoch
    std::vector<Json> changes_;
    std::size_t begun_ = 0;  // of them
    ListedChanges listed_;
    std::optional<Scene> scene_;  // of the present epoch; none: not known
};

/// Returns the recording's description of its samples. Its run is not the run of this stream.
Json about(const recordings::RecordingHead& head, const std::string& file) {
    Json about = measures::provenance_of_meta(head.provenance);
    if (about.contains("run")) {
        about["recorded_run"] = about["run"];
        about.erase("run");
    }
    about["program"] = "hertzline";
    about["replay"] = file;
    return about;
}

Exit replay(const ReplayOptions& arguments) {
    Faults faults;
    const auto fault = positive_fault(arguments.sample_rate_hz);
    faults.add("--sample-rate", fault);
    if (!fault && arguments.sample_rate_hz > stream::max_sample_rate_hz) {
        faults.add("--sample-rate",
                   fmt::format("found {} Hz, allowed: at most {} Hz", number_text(*arguments.sample_rate_hz),
                               number_text(stream::max_sample_rate_hz)));
    }
    faults.add(recordings::recording_fault(arguments.file, recordings::Access::reading));
    const std::optional<stream::CurveServer> curve = checked_curve(arguments.publish, faults);
    faults.refuse<WrongUse>();
    std::unique_ptr<recordings::RecordingReader> reader = recordings::open_reader(
        arguments.file, {.sample_rate_hz = arguments.sample_rate_hz,
                         .warn = [](const std::string& warning) { spdlog::warn("{}", warning); }});
    const recordings::RecordingHead head = reader->head();
    const double rate = sample_rate(head, arguments);
    stream::ReplaySource source(std::move(reader), rate, frame_samples(head.provenance));
    for (const std::string& warning : source.warnings()) {
        spdlog::warn("{}: {}", arguments.file, warning);
    }
    stream::StreamOptions options = stream_options(arguments.publish, rate, stream::OnOverrun::drop);
    options.about = about(head, arguments.file);
    RecordedScene scene(head.provenance);
    scene.add_to(options.about);
    const stream::PublisherOptions publishing = publisher_options(arguments.publish, source.format(), curve);
    throw_if(measures::memory_shortage("replaying " + arguments.file,
                                       stream_bytes(source.format(), options.pace, publishing)));
    stop_asked();
    stream::Publisher publisher(arguments.publish.endpoint, stream::all_topics, publishing);
    ProgressLine line;
    const std::int64_t first_sample = source.next_sample();
    stream::Pipeline pipeline(options, source, publisher, nullptr);
    publish_to_the_end(pipeline, publisher, line, arguments.publish.format,
                       {.add_to_summary =
                            [&](Json& summary, const stream::StreamMeters&) {
                                summary["replay"] = arguments.file;
                                summary["version"] = measures::program_version();
                            },
                        .epoch_begins = [&](const Epoch& epoch) { return scene.begin(epoch); },
                        .first_sample = first_sample});
    return Exit::done;
}

}  // namespace

Run replay_command(CLI::App& app) {
    auto arguments = std::make_shared<ReplayOptions>();
    app.add_option("FILE", arguments->file,
                   "a recording: " + recordings::recording_endings(recordings::Access::reading))
        ->required()
        ->check(missing_name);
    app.add_option("--sample-rate", arguments->sample_rate_hz,
                   "sample rate of a file without one, or in place of its own")
        ->type_name("HZ");
    add_publish_options(app, arguments->publish, "drop");
    app.footer(replay_examples);
    return [arguments] { return replay(*arguments); };
}

}  // namespace hertzline::app
