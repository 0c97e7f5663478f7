#include "stream/stream_plan.hpp"

#include <nlohmann/json.hpp>

#include "stream/scene_json.hpp"
#include "stream/taps.hpp"

namespace hertzline {

namespace {

using Json = nlohmann::ordered_json;

}  // namespace

std::string meta_json(const StreamPlan& plan, const std::string& run_id) {
    Json streams = Json::array();
    for (const Tap tap : taps_of(plan.scene.end.kind)) {
        const TapNames names = names_of(tap);
        streams.push_back({{"name", names.name},
                           {"topics", {names.raw_topic, names.np_topic}},
                           {"unit", names.unit},
                           {"channels", channels_of(tap, plan.scene.chain)},
                           {"fs", plan.scene.output.sample_rate_hz},
                           {"dtype", "<f4"}});
    }
    const Json meta{{"program", "hertzline"},
                    {"version", plan.version},
                    {"run", run_id},
                    {"scene_hash", plan.scene_hash},
                    {"estimated_error", plan.estimated_error ? Json(*plan.estimated_error) : Json(nullptr)},
                    {"fs", plan.scene.output.sample_rate_hz},
                    {"frame_samples", plan.scene.output.frame_samples},
                    {"pace", plan.pace.is_flat_out() ? Json("flat-out") : Json(plan.pace.times())},
                    {"security", word(plan.security)},
                    {"streams", streams},
                    {"units", {{"velocity", "m/s"}, {"time", "s"}, {"frequency", "Hz"}}},
                    {"scene", scene_json(plan.scene)}};
    return meta.dump();
}

std::string meters_json(const StreamMeters& meters, const std::string& run_id) {
    const Json json{{"run", run_id},
                    {"simulated_s", meters.simulated_s},
                    {"wall_s", meters.wall_s},
                    {"real_time_factor", meters.real_time_factor()},
                    {"load", meters.load},
                    {"frames", meters.frames},
                    {"late_frames", meters.late_frames},
                    {"dropped", meters.dropped_frames},
                    {"ring_fill", meters.ring_fill},
                    {"energy_residual", meters.energy_residual},
                    {"contact_events", meters.contact_events}};
    return json.dump();
}

}  // namespace hertzline
