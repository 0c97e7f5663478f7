// hertzline replay: a recording to whoever subscribes, as if it were live.

#include <memory>
#include <optional>
#include <string>

#include "apps/command.hpp"
#include "apps/commands/publish_session.hpp"
#include "apps/console/signals.hpp"
#include "core/scene/text.hpp"
#include "stream/pipeline/capacity.hpp"
#include "stream/provenance.hpp"
#include "stream/recordings/recording_formats.hpp"
#include "stream/resources.hpp"
#include "stream/sources/replay_source.hpp"

namespace hertzline::app {

namespace {

constexpr const char* examples =
    "The streams are the recording's v_out, v_last, v_plate and v_chain; of a recording that has none of "
    "these,\n"
    "one column is streamed as v_out and several as v_chain. Sample indices are the recording's, gaps "
    "included.\n"
    "Examples:\n"
    "  hertzline replay burst.sigmf-meta\n"
    "  hertzline replay burst.h5 --pace 0.01 --wait-for-subscriber\n"
    "  hertzline replay elsewhere.npy --sample-rate 1e6 --pace flat-out";

struct ReplayOptions {
    std::string file;
    std::optional<double> sample_rate_hz;
    StreamingRequest streaming;
};

constexpr std::int64_t usual_frame = 1024;
constexpr std::int64_t longest_frame = 1 << 20;

/// Frames as long as those of the run that was recorded, where that is known.
std::int64_t frame_samples(const Json& provenance) {
    const Json::json_pointer key("/scene/output/frame_samples");
    if (!provenance.is_object() || !provenance.contains(key) || !provenance.at(key).is_number_integer()) {
        return usual_frame;
    }
    const auto samples = provenance.at(key).get<std::int64_t>();
    return samples >= 1 && samples <= longest_frame ? samples : usual_frame;
}

/// The rate that the file tells or, where it tells none, the user.
double sample_rate(const stream::RecordingHead& head, const ReplayOptions& options) {
    if (options.sample_rate_hz) {
        return *options.sample_rate_hz;
    }
    if (head.sample_rate_hz == 0) {
        throw WrongUse(options.file + " does not tell its sampling rate: give --sample-rate");
    }
    return head.sample_rate_hz;
}

/// What the recording says of its samples; the run that it is of is not this one.
Json about(const stream::RecordingHead& head, const std::string& file) {
    Json about = stream::provenance_of_meta(head.provenance);
    if (about.contains("run")) {
        about["recorded_run"] = about["run"];
        about.erase("run");
    }
    about["program"] = "hertzline";
    about["replay"] = file;
    return about;
}

Exit replay(const ReplayOptions& options) {
    if (options.sample_rate_hz) {
        require_positive("--sample-rate", *options.sample_rate_hz);
    }
    if (const auto fault = stream::recording_fault(options.file)) {
        throw WrongUse(*fault);
    }
    const std::optional<stream::CurveServer> curve = checked(options.streaming);
    std::unique_ptr<stream::RecordingReader> reader = stream::open_reader(options.file);
    const stream::RecordingHead head = reader->head();
    const double rate = sample_rate(head, options);
    stream::ReplaySource source(std::move(reader), rate, frame_samples(head.provenance));
    stream::StreamOptions plan = plan_of(options.streaming, rate, stream::OnOverrun::drop);
    plan.about = about(head, options.file);
    if (const auto shortage = stream::memory_shortage("replaying " + options.file,
                                                      stream::ring_bytes(source.format(), plan.pace))) {
        throw std::runtime_error(*shortage);
    }
    stop_asked();
    stream::Publisher publisher(options.streaming.endpoint, all_topics,
                                publisher_options(source.format(), curve));
    ProgressLine line;
    stream::Pipeline pipeline(plan, source, publisher, nullptr);
    stream_to_the_end(pipeline, publisher, line, options.streaming.format,
                      [&](Json& summary, const stream::StreamMeters&) {
                          summary["replay"] = options.file;
                          summary["version"] = stream::program_version();
                      });
    return Exit::done;
}

}  // namespace

Command replay_command(CLI::App& program) {
    auto options = std::make_shared<ReplayOptions>();
    CLI::App* command = program.add_subcommand("replay", "publish a recording as if it were live");
    command->add_option("FILE", options->file, "a recording: " + stream::recording_endings())
        ->required()
        ->check(missing_name);
    command
        ->add_option("--sample-rate", options->sample_rate_hz,
                     "samples a second, for a file that does not tell")
        ->type_name("HZ");
    add_streaming_options(*command, options->streaming);
    command->footer(examples);
    return {command, [options] { return replay(*options); }};
}

}  // namespace hertzline::app
