#include "apps/commands/run/run_changes.hpp"

#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <utility>

#include "measures/provenance.hpp"
#include "recordings/files/input_file.hpp"
#include "recordings/recording_formats.hpp"
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "apps/command.hpp"
#include "core/integrators/kernels.hpp"
#include "core/scene/scene_json.hpp"
#include "core/scene/text.hpp"
#include "core/simulation.hpp"

namespace hertzline::app {

namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const std::string& where, const std::vector<Fault>& faults) {
    std::string text;
    for (const Fault& fault : faults) {
        text += (text.empty() ? "" : "\n") + where + ": " + fault.message();
    }
    throw WrongUse(text);
}

Scene changed(const Scene& scene, const Json& values, const std::string& where) {
    auto result = with_values(scene, values);
    if (!result) {
        refuse(where, result.error());
    }
    return *std::move(result);
}

/// The scene with integrator and step, at a hash that is known or not.
Scene resolved_step(const Scene& scene, const std::string& hash, const std::string& where) {
    if (const std::vector<Fault> faults = validate(scene); !faults.empty()) {
        refuse(where, faults);
    }
    if (scene.numerics.integrator && scene.numerics.step_s && !hash.empty() && scene_hash(scene) == hash) {
        return scene;
    }
    Resolution resolved = hertzline::resolve(scene, std::nullopt);
    if (!resolved.faults.empty()) {
        refuse(where, resolved.faults);
    }
    if (!hash.empty() && scene_hash(resolved.scene) != hash) {
        throw WrongUse(
            fmt::format("{}: found the scene hash {}, expected {}: it was another scene at the start, or "
                        "another version of the program",
                        where, scene_hash(resolved.scene), hash));
    }
    return std::move(resolved.scene);
}

/// The scenes that the changes make. @param scene with or without integrator and step
void add_steps(Session& session, Scene scene, const std::string& origin) {
    Scene before = session.resolved.scene;
    for (stream::SceneChange& change : session.changes) {
        const std::string where = fmt::format("{}: change from sample {} on", origin, change.sample);
        const Json asked = change.set;
        scene = changed(scene, asked, where);
        Scene after = resolved_step(scene, change.scene_hash, where);
        if (const std::vector<Fault> faults = stream::frame_faults(before, after); !faults.empty()) {
            refuse(where, faults);
        }
        const bool goes_on = stream::motion_goes_on(before, after);
        if (goes_on && !Simulation::can_hand_over(before)) {
            throw WrongUse(
                where +
                ": the motion of this grid cannot be handed over; allowed: a series, or steps that "
                "divide the sample period");
        }
        change.set = stream::values_of_change(after, asked);
        change.was = stream::values_of_change(before, asked);
        change.goes_on = goes_on;
        change.scene_hash = scene_hash(after);
        session.steps.push_back({change.sample, goes_on, after});
        before = std::move(after);
    }
}

std::vector<stream::SceneChange> changes_of(const Json& list, const std::string& origin) {
    auto changes = stream::changes_in(list);
    if (!changes) {
        throw WrongUse(origin + ": " + changes.error());
    }
    return *std::move(changes);
}

/// The scene in a recording's provenance.
Scene recorded_scene(const Json& provenance, const std::string& origin) {
    const auto found = provenance.is_object() ? provenance.find("scene") : provenance.end();
    if (!provenance.is_object() || found == provenance.end() || !found->is_object()) {
        throw WrongUse(origin + ": found no scene in this recording, allowed: recordings of hertzline");
    }
    auto scene = scene_of_json(*found);
    if (!scene) {
        refuse(origin, scene.error());
    }
    return *std::move(scene);
}

/// Index of the last sample.
std::int64_t last_sample(recordings::RecordingReader& reader) {
    constexpr std::size_t at_a_time = 4096;
    std::int64_t end = 0;
    const auto columns = static_cast<std::int64_t>(reader.head().columns.size());
    for (recordings::RecordedRows rows; reader.read(rows, at_a_time);) {
        end = rows.first + std::ssize(rows.values) / columns;
    }
    return std::max<std::int64_t>(0, end - 1);
}

/// The same bits need the same instructions.
void warn_of_differences(const Json& provenance, const std::string& origin) {
    const auto differs = [&](const char* key, const std::string& here) {
        const std::string there = provenance.value(key, here);
        if (there != here) {
            spdlog::warn("{}: recorded with {} {}, here it is {}: the samples may differ in their last bits",
                         origin, key, printable(there), here);
        }
    };
    differs("simd_target", kernels::kernel_target());
    differs("version", measures::program_version());
}

}  // namespace

bool is_recording(const std::string& scene) {
    std::error_code error;
    return !recordings::recording_ending(scene).empty() && !recordings::recording_fault(scene) &&
           fs::is_regular_file(scene, error);
}

Session session_of_recording(const SceneRequest& request) {
    const std::string origin = printable(request.scene);
    if (!request.settings.empty()) {
        throw WrongUse("--set: found together with a recording, allowed: with a scene");
    }
    const std::unique_ptr<recordings::RecordingReader> reader = recordings::open_reader(request.scene);
    const Json& provenance = reader->head().provenance;
    Session session;
    Scene scene = recorded_scene(provenance, origin);
    session.changes = changes_of(provenance.value("changes", Json::array()), origin);
    // a listener that joined later has the scene of the epoch in which it did
    const auto joined = provenance.value("epoch", std::int64_t{0});
    if (joined > 0 && (session.changes.empty() || session.changes.front().epoch != 1)) {
        throw WrongUse(fmt::format("{}: it begins in epoch {}, and does not hold all changes before it",
                                   origin, joined));
    }
    for (auto change = session.changes.rbegin(); change != session.changes.rend(); ++change) {
        if (change->epoch <= joined) {
            scene = changed(scene, change->was.is_null() ? Json::object() : change->was, origin);
        }
    }
    warn_of_differences(provenance, origin);
    session.resolved = hertzline::resolve(scene, std::nullopt);
    if (!session.resolved.faults.empty()) {
        refuse(origin, session.resolved.faults);
    }
    add_steps(session, scene, origin);
    const double duration_s = static_cast<double>(last_sample(*reader)) / scene.output.sample_rate_hz;
    session.resolved.scene.output.duration_s = duration_s;
    return session;
}

Session session_of_scene(const SceneRequest& request, const std::string& file) {
    if (file.empty()) {
        return {.resolved = resolved_scene(request), .changes = {}, .steps = {}};
    }
    constexpr std::uint64_t largest = 64 << 20;
    Session session;
    session.resolved = resolved_scene(request);
    try {
        recordings::InputFile input(file);
        const Json json = json_from_outside(input.text(std::min(input.size(), largest), "the changes"));
        session.changes = changes_of(json.is_object() && json.contains("changes") ? json["changes"] : json,
                                     "--changes " + printable(file));
    } catch (const WrongUse&) {
        throw;
    } catch (const std::runtime_error& error) {
        throw WrongUse(std::string("--changes: ") + error.what());
    }
    add_steps(session, parsed_scene(request).scene, "--changes " + printable(file));
    return session;
}

}  // namespace hertzline::app
