#include "measures/provenance.hpp"

#include <algorithm>
#include <array>
#include <string_view>

#include "git_hash.hpp"
#include <fmt/chrono.h>
#include <fmt/format.h>

#include "core/integrators/kernels.hpp"
#include "core/model/end.hpp"
#include "core/scene/json.hpp"
#include "core/scene/scene_json.hpp"
#include "core/scene/scene_words.hpp"
#include "hertzline/scene_file.hpp"
#include "hertzline/taps.hpp"

namespace hertzline::measures {

namespace {

constexpr std::array<std::string_view, 21> keys{"program",
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
                                                "asked_numerics",
                                                "scene",
                                                "epoch",
                                                "epoch_sample",
                                                "epoch_burst",
                                                "control",
                                                "changes",
                                                "changes_left_out"};

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

Json maker_json() {
    return {{"program", "hertzline"},
            {"version", program_version()},
            {"git_hash", git_hash()},
            {"compiler", compiler()},
            {"simd_target", kernels::kernel_target()}};
}

Json provenance_json(const Resolution& resolved, const std::optional<std::string>& run) {
    const Scene& scene = resolved.scene;
    Json json = maker_json();
    json["start_time"] = utc_text(std::chrono::system_clock::now());
    if (run) {
        json["run"] = *run;
    }
    json["scene_hash"] = scene_hash(scene);
    json["integrator"] = scene.numerics.integrator ? Json(word(*scene.numerics.integrator)) : Json(nullptr);
    json["step_s"] = scene.numerics.step_s ? Json(*scene.numerics.step_s) : Json(nullptr);
    add_estimate(json, resolved.estimate);
    if (provides(scene, Requires::modal_plate)) {
        json["p_axis_travel_s"] = plate_parameters(scene).travel_s();
    }
    Scene asked;
    asked.numerics = resolved.asked;
    json["asked_numerics"] = scene_json(asked)["numerics"];
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
    if (json.value("epoch", Json(0)) == 0) {  // the first one, also by default
        for (const char* key : {"epoch", "epoch_sample", "epoch_burst"}) {
            json.erase(key);
        }
    }
    return json;
}

namespace {

std::optional<double> repetition_at(std::string_view path, const Json& json) {
    constexpr double most = 1e9;  // as in a scene
    const auto rate = OutsideJson(json).number(path);
    return rate && *rate >= 0 && *rate <= most ? rate : std::nullopt;
}

std::int64_t count_in(const Json& json, std::string_view key) {
    constexpr std::int64_t most = 9'000'000'000'000'000'000;
    return std::min(OutsideJson(json).count(key).value_or(0), most);
}

}  // namespace

std::optional<double> repetition_of(const Json& provenance) {
    return repetition_at("scene/drive/repetition_hz", provenance);
}

std::vector<Epoch> epochs_of(const Json& provenance, double sample_rate_hz) {
    const auto repetition = repetition_of(provenance);
    if (!repetition) {
        return {};
    }
    std::vector<Epoch> epochs{{.number = count_in(provenance, "epoch"),
                               .first_sample = count_in(provenance, "epoch_sample"),
                               .first_burst = count_in(provenance, "epoch_burst"),
                               .repetition_hz = *repetition}};
    for (const Json& change : OutsideJson(provenance).at("changes")) {
        add_epoch(epochs, change, sample_rate_hz);
    }
    return epochs;
}

void add_epoch(std::vector<Epoch>& epochs, const Json& change, double sample_rate_hz) {
    const Epoch before = epochs.back();
    if (count_in(change, "epoch") <= before.number || count_in(change, "sample") < before.first_sample) {
        return;
    }
    const auto rate = repetition_at("set/drive.repetition_hz", change);
    epochs.push_back(
        before.next(sample_rate_hz, count_in(change, "sample"), rate.value_or(before.repetition_hz)));
    epochs.back().number = count_in(change, "epoch");
}

}  // namespace hertzline::measures
