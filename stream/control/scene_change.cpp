#include "stream/control/scene_change.hpp"

#include <utility>

#include <fmt/format.h>

#include "core/scene/scene_json.hpp"
#include "core/scene/scene_key.hpp"

namespace hertzline::stream {

Json faults_json(const std::vector<Fault>& faults) {
    Json list = Json::array();
    for (const Fault& fault : faults) {
        list.push_back({{"key", fault.key},
                        {"found", fault.found},
                        {"allowed", fault.allowed},
                        {"message", fault.message()}});
    }
    return {{"faults", std::move(list)}};
}

bool motion_goes_on(const Scene& from, const Scene& to) {
    Scene same = from;
    same.drive = to.drive;
    same.drive.material = from.drive.material;
    same.numerics.step_s = to.numerics.step_s;
    same.numerics.accuracy = to.numerics.accuracy;
    return same == to;
}

std::vector<Fault> frame_faults(const Scene& from, const Scene& to) {
    std::vector<Fault> faults;
    const auto add = [&](const char* name) {
        const SceneValue value = scene_key_named(to, name)->value(to).value_or(std::string("none"));
        faults.push_back(
            {name, value_text(value), "the value at the start of the stream, on which its frames depend"});
    };
    if (from.output.sample_rate_hz != to.output.sample_rate_hz) {
        add("output.sample_rate_hz");
    }
    if (from.output.frame_samples != to.output.frame_samples) {
        add("output.frame_samples");
    }
    if (from.output.duration_s != to.output.duration_s) {
        add("output.duration_s");
    }
    if (from.chain.spheres != to.chain.spheres) {
        add("chain.spheres");
    }
    if (taps_of(from.end) != taps_of(to.end)) {
        add(from.end.kind != to.end.kind ? "end.kind" : "end.model");
    }
    return faults;
}

Json values_of_change(const Scene& to, const Json& asked) {
    Json keys = asked;
    for (const char* key : {"numerics.integrator", "numerics.step_s", "numerics.accuracy"}) {
        keys[key] = nullptr;
    }
    if (to.numerics.poles) {  // of a modal plate
        keys["numerics.poles"] = nullptr;
    }
    return values_of_keys(to, keys);
}

Json change_json(const SceneChange& change) {
    Json json{{"sample", change.sample}, {"epoch", change.epoch}, {"set", change.set}};
    if (!change.was.is_null()) {
        json["was"] = change.was;
    }
    json["motion"] = change.goes_on ? "goes on" : "begins anew";
    if (!change.scene_hash.empty()) {
        json["scene_hash"] = change.scene_hash;
    }
    return json;
}

tl::expected<std::vector<SceneChange>, std::string> changes_in(const Json& list) {
    if (!list.is_array()) {
        return tl::unexpected(
            std::string(R"(found no list, allowed: [{"sample": 20000, "set": {...}}, ...])"));
    }
    std::vector<SceneChange> changes;
    for (const Json& entry : list) {
        const auto wrong = [&](const char* what) {
            return tl::unexpected(fmt::format("change {}: {}", changes.size() + 1, what));
        };
        if (!entry.is_object()) {
            return wrong(R"(found no object, allowed: {"sample": 20000, "set": {...}})");
        }
        const OutsideJson outside(entry);
        SceneChange change;
        change.sample = outside.count("sample").value_or(0);
        change.epoch = entry.contains("epoch") ? outside.count("epoch").value_or(0) : std::ssize(changes) + 1;
        if (change.sample < 1 || (!changes.empty() && change.sample <= changes.back().sample)) {
            return wrong("\"sample\" is missing or not a whole number above that of the change before");
        }
        if (change.epoch < 1 || (!changes.empty() && change.epoch != changes.back().epoch + 1)) {
            return wrong("\"epoch\" does not follow that of the change before");
        }
        if (!outside.at("set").is_object()) {
            return wrong("\"set\" is missing or not an object of keys and values");
        }
        change.set = outside.at("set");
        if (outside.at("was").is_object()) {
            change.was = outside.at("was");
        }
        change.scene_hash = outside.text("scene_hash");
        changes.push_back(std::move(change));
    }
    return changes;
}

}  // namespace hertzline::stream
