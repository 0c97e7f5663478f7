#include "stream/pipeline/stream_messages.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "core/scene/json.hpp"
#include "core/scene/scene_words.hpp"
#include "hertzline/scene_file.hpp"
#include "measures/provenance.hpp"
#include "stream/pipeline/pipeline.hpp"
#include "stream/wire/topics.hpp"

namespace hertzline::stream {

std::string meta_json(const StreamOptions& options, const StreamFormat& format) {
    Json streams = Json::array();
    for (const Tap tap : format.taps) {
        const TapRow& row = row_of(tap);
        const TapTopics& topics = topics_of(tap);
        streams.push_back({{"name", row.name},
                           {"topics", {std::string_view(topics.raw), std::string_view(topics.np)}},
                           {"unit", row.unit},
                           {"channels", format.channels(tap)},
                           {"fs", format.sample_rate_hz},
                           {"dtype", "<f4"}});
    }
    Json meta = options.about;
    meta.update(Json{{"run", options.run},
                     {"epoch", options.epoch.number},
                     {"epoch_sample", options.epoch.first_sample},
                     {"epoch_burst", options.epoch.first_burst},
                     {"fs", format.sample_rate_hz},
                     {"frame_samples", format.frame_samples},
                     {"pace", options.pace.is_flat_out() ? Json("flat-out") : Json(options.pace.times())},
                     {"streams", streams},
                     {"units",
                      {{"velocity", "m/s"},
                       {"displacement", "m"},
                       {"force", "N"},
                       {"pressure", "Pa"},
                       {"time", "s"},
                       {"frequency", "Hz"}}}});
    if (format.latency_samples) {
        meta["latency_samples"] = *format.latency_samples;
    }
    // A file name need not be UTF-8.
    return json_text(meta);
}

void add_stream_members(Json& object, const StreamMeters& meters, TapSet taps) {
    object["simulated_s"] = meters.simulated_s;
    object["wall_s"] = meters.wall_s;
    object["real_time_factor"] = meters.real_time_factor();
    object["load"] = meters.load;
    object["frames"] = meters.frames;
    object["late_frames"] = meters.late_frames;
    object["largest_lateness_s"] = meters.largest_lateness_s;
    object["ring_high_water"] = meters.ring_high_water;
    object["energy_residual"] = meters.account.energy_residual;
    object["contact_events"] = meters.account.contact_events;
    if (meters.drive) {
        object["drive_samples"] = meters.drive->samples;
        object["drive_underruns"] = meters.drive->underruns;
        object["drive_zeros"] = meters.drive->zeros;
        object["drive_lost"] = meters.drive->lost;
        object["drive_refused"] = meters.drive->refused;
    }
    for (const Tap tap : taps) {
        const std::string_view name = row_of(tap).name;
        object[fmt::format("{}_raw_sent", name)] = meters.raw(tap).sent;
        object[fmt::format("{}_raw_dropped", name)] = meters.raw(tap).dropped;
        object[fmt::format("{}_np_sent", name)] = meters.np(tap).sent;
        object[fmt::format("{}_np_dropped", name)] = meters.np(tap).dropped;
    }
}

std::string meters_json(const StreamMeters& meters, TapSet taps, const std::string& run) {
    Json json{{"run", run}};
    add_stream_members(json, meters, taps);
    json["dropped"] = meters.dropped_frames;
    json["ring_fill"] = meters.ring_fill;
    return json.dump();
}

std::string lateness_text(const StreamMeters& meters) {
    return fmt::format(
        "the stream is {:.1f} s late, at {:.3g} of real time: this machine, or what gives the samples, does "
        "not "
        "keep up",
        meters.largest_lateness_s, meters.real_time_factor());
}

Json summary_json(const StreamMeters& meters, const Pipeline& pipeline, const Publisher& publisher) {
    Json summary;
    add_stream_members(summary, meters, pipeline.format().taps);
    summary["samples"] = meters.samples;
    summary["dropped_frames"] = meters.dropped_frames;
    summary["endpoint"] = publisher.endpoint();
    summary["security"] = word(publisher.security());
    summary["refused_clients"] = publisher.refused_clients();
    summary["run"] = pipeline.options().run;
    return summary;
}

void add_simulation(Json& summary, const StreamMeters& meters, const Scene& last,
                    const std::optional<ErrorEstimate>& estimate, Json recordings) {
    summary["recordings"] = std::move(recordings);
    summary["steps"] = meters.account.steps;
    summary["step_s"] = *last.numerics.step_s;
    summary["integrator"] = word(*last.numerics.integrator);
    measures::add_estimate(summary, estimate);
    summary["scene_hash"] = scene_hash(last);
    summary["version"] = measures::program_version();
}

}  // namespace hertzline::stream
