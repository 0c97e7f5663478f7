#include "stream/control/scene_change.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "core/model/drive.hpp"
#include "core/scene/elements.hpp"
#include "core/scene/scene_json.hpp"
#include "core/scene/scene_key.hpp"
#include "core/scene/text.hpp"
#include "measures/provenance.hpp"

namespace hertzline::stream {

namespace {

struct FixedKey {
    std::string_view name;
    const char* allowed;
};
constexpr const char* value_at_start = "the value at the start of the stream, on which its frames depend";
constexpr std::array fixed_keys{
    FixedKey{"output.sample_rate_hz", value_at_start}, FixedKey{"output.frame_samples", value_at_start},
    FixedKey{"output.duration_s",
             "the value at the start of the stream, which ends when it is stopped or after --duration"},
    FixedKey{"chain.spheres", value_at_start}};

}  // namespace

bool is_fixed(std::string_view key) noexcept {
    return std::ranges::find(fixed_keys, key, &FixedKey::name) != fixed_keys.end();
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

std::vector<Fault> frame_faults(const Scene& from, const Scene& to) {
    std::vector<Fault> faults;
    const auto add = [&](std::string_view name, const char* allowed = value_at_start) {
        const SceneValue value = scene_key_named(to, name)->value(to).value_or(std::string("none"));
        faults.push_back({std::string(name), value_text(value), allowed});
    };
    for (const FixedKey& key : fixed_keys) {
        if (scene_key_named(from, key.name)->value(from) != scene_key_named(to, key.name)->value(to)) {
            add(key.name, key.allowed);
        }
    }
    if (awaits_samples(to.drive) && !awaits_samples(from.drive)) {
        add("drive.kind", "a drive whose motion is there: a live one is connected at the start of a stream");
    }
    if (from.array.x_m.size() != to.array.x_m.size()) {
        add("array.x_m");
    } else if (from.output.points_m.size() != to.output.points_m.size()) {
        add("output.points_m");
    } else if (taps_of(from) != taps_of(to)) {
        add(from.end.kind != to.end.kind ? "end.kind" : "end.model");
    }
    if (!from.drive.samples.empty() && from.drive.samples == to.drive.samples) {
        for (const SceneKey& key : scene_keys()) {
            if (key.traits.reads_record && key.value(from) != key.value(to)) {
                add(key.name, "the value by which the record was read");
            }
        }
    }
    return faults;
}

double expected_real_time_factor(const Resolution& resolved) {
    constexpr double body_steps_per_s = 5e7;  // of a series on one processor, within a factor of some
    const Drive& drive = resolved.scene.drive;
    const double bodies = static_cast<double>(resolved.scene.chain.spheres) + 1;
    const double steps_per_s = resolved.steps_per_burst / burst_duration_s(drive);
    return body_steps_per_s / (steps_per_s * bodies);
}

std::string real_time_factor_text(double factor) {
    return fmt::format("a real-time factor of about {:.1g}", factor);
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

namespace {
constexpr std::array<std::string_view, 2> motion_words{"goes on", "begins anew"};
}  // namespace

Json change_json(const SceneChange& change) {
    Json json{{"sample", change.sample}, {"epoch", change.epoch}, {"set", change.set}};
    if (!change.was.is_null()) {
        json["was"] = change.was;
    }
    json["motion"] = motion_words[change.goes_on ? 0 : 1];
    if (!change.scene_hash.empty()) {
        json["scene_hash"] = change.scene_hash;
    }
    if (change.estimate) {
        measures::add_estimate(json, change.estimate);
    }
    return json;
}

namespace {

constexpr std::array<std::string_view, 8> members{
    "sample", "epoch", "set", "was", "motion", "scene_hash", "estimated_error", "estimated_over_s"};

/// Returns the fault of an entry's members, or reads them. @param before the change before; null: none
tl::expected<SceneChange, std::string> change_in(const Json& entry, const SceneChange* before) {
    if (!entry.is_object()) {
        return tl::unexpected(std::string(R"(found no object, allowed: {"sample": 20000, "set": {...}})"));
    }
    for (const auto& member : entry.items()) {
        if (std::ranges::find(members, member.key()) == members.end()) {
            return tl::unexpected(fmt::format("found the member {}, allowed: {}",
                                              quoted_briefly(member.key()), fmt::join(members, ", ")));
        }
    }
    const OutsideJson outside(entry);
    SceneChange change;
    const std::string motion =
        entry.contains("motion") ? outside.text("motion") : std::string(motion_words[0]);
    if (std::ranges::find(motion_words, motion) == motion_words.end()) {
        return tl::unexpected(fmt::format("motion: found {}, allowed: {}", quoted_briefly(motion),
                                          fmt::join(motion_words, ", ")));
    }
    change.goes_on = motion == motion_words[0];
    change.must_go_on = change.goes_on && entry.contains("motion");
    constexpr std::int64_t latest = std::numeric_limits<std::int64_t>::max() - 1;  // one more may follow
    const std::int64_t earliest = before == nullptr ? 1 : before->sample + (change.goes_on ? 1 : 0);
    change.sample = outside.count("sample").value_or(0);
    if (change.sample < earliest || change.sample > latest) {
        return tl::unexpected(fmt::format(
            "sample: found {}, allowed: a whole number from {} to {}",
            entry.contains("sample") ? quoted_briefly(entry["sample"].dump()) : "none", earliest, latest));
    }
    const std::int64_t following = before == nullptr ? 1 : before->epoch + 1;
    change.epoch = entry.contains("epoch") ? outside.count("epoch").value_or(0) : following;
    if (change.epoch < 1 || change.epoch > latest || (before != nullptr && change.epoch != following)) {
        return tl::unexpected(std::string("epoch: it does not follow that of the change before"));
    }
    if (!outside.at("set").is_object()) {
        return tl::unexpected(std::string("set: it is missing or not an object of keys and values"));
    }
    change.set = outside.at("set");
    if (outside.at("was").is_object()) {
        change.was = outside.at("was");
    }
    change.scene_hash = outside.text("scene_hash");
    if (const auto error = outside.number("estimated_error")) {
        change.estimate = {.error = *error, .over_s = outside.number("estimated_over_s").value_or(0)};
    }
    return change;
}

}  // namespace

tl::expected<std::vector<SceneChange>, std::string> changes_in(const Json& list) {
    if (!list.is_array()) {
        return tl::unexpected(
            std::string(R"(found no list, allowed: [{"sample": 20000, "set": {...}}, ...])"));
    }
    std::vector<SceneChange> changes;
    for (const Json& entry : list) {
        auto change = change_in(entry, changes.empty() ? nullptr : &changes.back());
        if (!change) {
            return tl::unexpected(fmt::format("change {}: {}", changes.size() + 1, change.error()));
        }
        changes.push_back(*std::move(change));
    }
    return changes;
}

}  // namespace hertzline::stream
