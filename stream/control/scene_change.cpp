#include "stream/control/scene_change.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "core/scene/json.hpp"
#include "core/scene/scene_key.hpp"
#include "core/scene/scene_toml.hpp"
#include "core/scene/text.hpp"

namespace hertzline::stream {

namespace {

const char* word_of(ValueKind kind) noexcept {
    switch (kind) {
        case ValueKind::number:
            return "number";
        case ValueKind::integer:
            return "integer";
        case ValueKind::word:
            return "word";
    }
    return "";
}

Json json_of(const std::optional<SceneValue>& value) {
    return value ? std::visit([](const auto& held) { return Json(held); }, *value) : Json(nullptr);
}

/// What stands there, for a message.
std::string found_text(const Json& value) {
    return quoted_briefly(value.dump(-1, ' ', true, Json::error_handler_t::replace));
}

/// The value as the key takes it; nothing when it is of another kind.
std::optional<SceneValue> value_as(ValueKind kind, const Json& value) {
    constexpr double whole_below = 9e15;
    if (kind == ValueKind::word) {
        return value.is_string() ? std::optional<SceneValue>(value.get<std::string>()) : std::nullopt;
    }
    if (!value.is_number()) {
        return std::nullopt;
    }
    const auto number = value.get<double>();
    if (kind == ValueKind::number) {
        return number;
    }
    if (number != std::floor(number) || std::abs(number) > whole_below) {
        return std::nullopt;
    }
    return static_cast<std::int64_t>(number);
}

/// The fault of a name that is no key.
Fault unknown(const std::string& name, Fault fault) {
    fault.key = quoted_briefly(name);
    fault.found = "an unknown key";
    return fault;
}

/// Sets one key. @returns what is wrong
std::optional<Fault> set_key(Scene& scene, const std::string& name, const Json& json) {
    auto key = scene_key_named(scene, name);
    if (!key) {
        return unknown(name, std::move(key).error());
    }
    if (json.is_null()) {
        return unset_value(scene, name) ? std::nullopt
                                        : std::optional(Fault{name, "null", key->allowed + ", always"});
    }
    const auto value = value_as(key->kind, json);
    if (!value) {
        return Fault{name, found_text(json), key->allowed};
    }
    if (auto fault = value_fault(scene, *key, *value)) {
        return fault;
    }
    set_value(scene, name, *value);
    return std::nullopt;
}

Json described(const Scene& scene, const SceneKeyInfo& key) {
    Json entry{{"value", json_of(value_of(scene, key.name))}};
    if (!key.unit.empty()) {
        entry["unit"] = key.unit;
    }
    if (key.minimum && key.kind == ValueKind::integer) {
        entry["minimum"] = static_cast<std::int64_t>(*key.minimum);
        entry["maximum"] = static_cast<std::int64_t>(*key.maximum);
    } else if (key.minimum) {
        entry["minimum"] = *key.minimum;
        entry["maximum"] = *key.maximum;
    }
    entry["kind"] = word_of(key.kind);
    if (!key.words.empty()) {
        entry["words"] = key.words;
    }
    entry["description"] = key.allowed;
    return entry;
}

std::int64_t whole_in(const Json& object, const char* key) {
    const auto found = object.find(key);
    return found != object.end() && found->is_number_integer() ? found->get<std::int64_t>() : -1;
}

}  // namespace

tl::expected<Scene, std::vector<Fault>> with_values(Scene scene, const Json& values) {
    std::vector<Fault> faults;
    for (const auto& [name, value] : values.items()) {
        if (auto fault = set_key(scene, name, value)) {
            faults.push_back(*std::move(fault));
        }
    }
    if (!faults.empty()) {
        return tl::unexpected(std::move(faults));
    }
    return scene;
}

Json values_of_keys(const Scene& scene, const Json& values) {
    Json found = Json::object();
    for (const auto& entry : values.items()) {
        found[entry.key()] = json_of(value_of(scene, entry.key()));
    }
    return found;
}

tl::expected<Json, std::vector<Fault>> described_values(const Scene& scene,
                                                        const std::vector<std::string>& keys) {
    Json all = Json::object();
    std::vector<Fault> faults;
    for (const std::string& name : keys.empty() ? scene_key_names(scene) : keys) {
        if (auto key = scene_key_named(scene, name)) {
            all[name] = described(scene, *key);
        } else {
            faults.push_back(unknown(name, std::move(key).error()));
        }
    }
    if (!faults.empty()) {
        return tl::unexpected(std::move(faults));
    }
    return all;
}

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
    const std::string allowed = "what the stream began with: frames hold it";
    std::vector<Fault> faults;
    const auto add = [&](const char* key) {
        faults.push_back({key, value_text(value_of(to, key).value_or(std::string("none"))), allowed});
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
    Json set = values_of_keys(to, asked);
    for (const char* key : {"numerics.integrator", "numerics.step_s", "numerics.accuracy"}) {
        set[key] = json_of(value_of(to, key));
    }
    if (to.numerics.poles) {  // of a modal plate
        set["numerics.poles"] = *to.numerics.poles;
    }
    return set;
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
        SceneChange change;
        change.sample = whole_in(entry, "sample");
        change.epoch = entry.contains("epoch") ? whole_in(entry, "epoch") : std::ssize(changes) + 1;
        if (change.sample < 1 || (!changes.empty() && change.sample <= changes.back().sample)) {
            return wrong("\"sample\" is missing or not a whole number above that of the change before");
        }
        if (change.epoch < 1 || (!changes.empty() && change.epoch != changes.back().epoch + 1)) {
            return wrong("\"epoch\" does not follow that of the change before");
        }
        if (!entry.contains("set") || !entry["set"].is_object()) {
            return wrong("\"set\" is missing or not an object of keys and values");
        }
        change.set = entry["set"];
        if (entry.contains("was") && entry["was"].is_object()) {
            change.was = entry["was"];
        }
        if (entry.contains("scene_hash") && entry["scene_hash"].is_string()) {
            change.scene_hash = entry["scene_hash"].get<std::string>();
        }
        changes.push_back(std::move(change));
    }
    return changes;
}

}  // namespace hertzline::stream
