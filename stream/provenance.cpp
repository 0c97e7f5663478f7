#include "stream/provenance.hpp"

#include <array>
#include <string_view>

#include "git_hash.hpp"
#include <fmt/chrono.h>
#include <fmt/format.h>

#include "core/integrators/kernels.hpp"
#include "core/model/end.hpp"
#include "core/scene/scene_toml.hpp"
#include "core/scene/scene_words.hpp"
#include "core/taps.hpp"
#include "stream/scene_json.hpp"

namespace hertzline::stream {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::array<std::string_view, 14> keys{"program",
                                                "version",
                                                "git_hash",
                                                "compiler",
                                                "simd_target",
                                                "start_time",
                                                "run",
                                                "scene_hash",
                                                "integrator",
                                                "step_s",
                                                "estimated_error",
                                                "estimated_over_s",
                                                "p_axis_travel_s",
                                                "scene"};

}  // namespace

const char* program_version() noexcept {
    return HERTZLINE_VERSION;
}

const char* git_hash() noexcept {
    return HERTZLINE_GIT_HASH;
}

const char* compiler() noexcept {
    return HERTZLINE_COMPILER;
}

std::string utc_text(std::chrono::system_clock::time_point time) {
    using std::chrono::milliseconds;
    const auto since_epoch = std::chrono::floor<milliseconds>(time.time_since_epoch());
    const auto seconds = std::chrono::floor<std::chrono::seconds>(since_epoch);
    return fmt::format("{:%Y-%m-%dT%H:%M:%S}.{:03}Z", fmt::gmtime(static_cast<std::time_t>(seconds.count())),
                       (since_epoch - seconds).count());
}

Json provenance_json(const Provenance& provenance) {
    const Scene& scene = provenance.scene;
    Json json{{"program", "hertzline"},
              {"version", program_version()},
              {"git_hash", git_hash()},
              {"compiler", compiler()},
              {"simd_target", kernels::kernel_target()},
              {"start_time", provenance.start_time}};
    if (provenance.run) {
        json["run"] = *provenance.run;
    }
    json["scene_hash"] = scene_hash(scene);
    json["integrator"] = scene.numerics.integrator ? Json(word(*scene.numerics.integrator)) : Json(nullptr);
    json["step_s"] = scene.numerics.step_s ? Json(*scene.numerics.step_s) : Json(nullptr);
    add_estimate(json, provenance.estimate);
    if (provides(scene.end, Requires::modal_plate)) {
        json["p_axis_travel_s"] = plate_parameters(scene).travel_s();
    }
    json["scene"] = scene_json(scene);
    return json;
}

void add_estimate(Json& json, const std::optional<ErrorEstimate>& estimate) {
    json["estimated_error"] = estimate ? Json(estimate->error) : Json(nullptr);
    json["estimated_over_s"] = estimate ? Json(estimate->over_s) : Json(nullptr);
}

Json provenance_of_meta(const Json& meta) {
    Json json = Json::object();
    for (const std::string_view key : keys) {
        if (meta.is_object() && meta.contains(key)) {
            json[std::string(key)] = meta[std::string(key)];
        }
    }
    return json;
}

std::optional<double> repetition_of(const nlohmann::ordered_json& provenance) {
    const nlohmann::ordered_json::json_pointer path("/scene/drive/repetition_hz");
    if (!provenance.contains(path)) {
        return std::nullopt;
    }
    const auto& value = provenance.at(path);
    constexpr double most = 1e9;  // as in a scene
    const bool usable = value.is_number() && value.get<double>() >= 0 && value.get<double>() <= most;
    return usable ? std::optional(value.get<double>()) : std::nullopt;
}

}  // namespace hertzline::stream
