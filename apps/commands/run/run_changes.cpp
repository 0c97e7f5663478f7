#include "apps/commands/run/run_changes.hpp"

#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "core/integrators/kernels.hpp"
#include "core/model/drive.hpp"
#include "core/scene/faults.hpp"
#include "core/scene/scene_json.hpp"
#include "core/scene/text.hpp"
#include "hertzline/simulation.hpp"
#include "measures/measuring.hpp"
#include "measures/provenance.hpp"
#include "measures/run.hpp"
#include "recordings/files/input_file.hpp"
#include "recordings/formats/wav.hpp"
#include "recordings/recording_formats.hpp"

namespace hertzline::app {

namespace {

namespace fs = std::filesystem;

/// Resolves the scene, or adds its faults. @param hash of the resolved scene; empty: not known @param run_s how long it lasts
std::optional<Resolution> resolved_step(const Scene& scene, const std::string& hash, double run_s,
                                        const std::string& where, Faults& faults) {
    if (const std::vector<Fault> wrong = validate(scene); !wrong.empty()) {
        faults.add(where, wrong);
        return std::nullopt;
    }
    if (scene.numerics.integrator && scene.numerics.step_s && !hash.empty() && scene_hash(scene) == hash) {
        Resolution known;
        known.scene = scene;
        known.step_set_by_scene = true;
        return known;
    }
    Resolution resolved = hertzline::resolve(scene, run_s);
    if (!resolved.faults.empty()) {
        faults.add(where, resolved.faults);
        return std::nullopt;
    }
    if (!hash.empty() && scene_hash(resolved.scene) != hash) {
        faults.add(where,
                   fmt::format("found the scene hash {}, expected {}: it was another scene at the start, or "
                               "another version of the program",
                               scene_hash(resolved.scene), hash));
        return std::nullopt;
    }
    return resolved;
}

/// Resolves the scene of a change and completes the change, or adds the faults. Replaces `scene`, which is without
/// integrator and step unless the user gave them, and `before`, which has them.
/// @param run_s how long the changed scene lasts
bool take_step(Session& session, stream::SceneChange& change, Scene& scene, Scene& before, double run_s,
               const std::string& where, Faults& faults) {
    const Json asked = change.set;
    auto changed = faults.value_of(where, with_values(scene, asked));
    const auto resolved =
        changed ? resolved_step(*changed, change.scene_hash, run_s, where, faults) : std::nullopt;
    if (!resolved) {
        return false;
    }
    const Scene* const after = &resolved->scene;
    if (const std::vector<Fault> wrong = stream::frame_faults(before, *after); !wrong.empty()) {
        faults.add(where, wrong);
        return false;
    }
    const bool continues = change.goes_on && stream::motion_goes_on(before, *after);
    if (change.must_go_on && !continues) {
        faults.add(
            where,
            "motion: found \"goes on\", but these keys restart the motion; allowed: \"begins anew\", or a "
            "change without this member");
        return false;
    }
    if (continues && !Simulation::can_hand_over(before)) {
        faults.add(where,
                   "the motion of this grid cannot be handed over; allowed: a series, or steps that "
                   "divide the sample period");
        return false;
    }
    change.set = stream::values_of_change(*after, asked);
    change.was = stream::values_of_change(before, asked);
    change.goes_on = continues;
    change.scene_hash = scene_hash(*after);
    if (resolved->estimate) {  // else it is a recorded change, which has the estimate of its stream
        change.estimate = resolved->estimate;
    }
    if (const auto missed = measures::missed_accuracy(*resolved)) {
        session.warnings.push_back(where + ": " + *missed);
    }
    session.steps.push_back({change.sample, continues, *after, change.estimate});
    scene = *std::move(changed);
    before = *after;
    return true;
}

std::string place_of(const std::string& origin, const stream::SceneChange& change) {
    return fmt::format("{}: change from sample {} on", origin, change.sample);
}

/// Whether the values of all changes are allowed by themselves; adds the faults of those that are not.
bool have_allowed_values(const std::vector<stream::SceneChange>& changes, Scene scene,
                         const std::string& origin, Faults& faults) {
    bool allowed = true;
    for (const stream::SceneChange& change : changes) {
        if (auto changed = faults.value_of(place_of(origin, change), with_values(scene, change.set))) {
            scene = *std::move(changed);
        } else {
            allowed = false;
        }
    }
    return allowed;
}

/// Adds the scenes that the changes make, or their faults: those of all values, else those of the first scene that is wrong.
/// @param scene with or without integrator and step @param samples of the session
std::optional<Session> with_steps(Session session, Scene scene, std::int64_t samples,
                                  const std::string& origin, Faults& faults) {
    if (!have_allowed_values(session.changes, scene, origin, faults)) {
        return std::nullopt;
    }
    Scene before = session.resolved.scene;
    for (std::size_t i = 0; i < session.changes.size(); ++i) {
        stream::SceneChange& change = session.changes[i];
        const std::int64_t end = i + 1 < session.changes.size() ? session.changes[i + 1].sample : samples;
        const double run_s =
            static_cast<double>(std::max<std::int64_t>(1, end - change.sample)) / scene.output.sample_rate_hz;
        if (!take_step(session, change, scene, before, run_s, place_of(origin, change), faults)) {
            return std::nullopt;
        }
    }
    return session;
}

/// Returns the changes of a recording's provenance, or adds the fault of those that are missing.
std::optional<std::vector<stream::SceneChange>> recorded_changes(const Json& provenance,
                                                                 const std::string& origin, Faults& faults) {
    if (provenance.value("control", Json(false)) == true && !provenance.contains("changes")) {
        faults.add(origin, fmt::format("its scene could change, but the list of changes is missing{}",
                                       recordings::recording_ending(origin) == ".wav"
                                           ? ": it is in " + recordings::wav_changes_path(origin).string()
                                           : std::string()));
        return std::nullopt;
    }
    return faults.value_of(origin, stream::changes_in(provenance.value("changes", Json::array())));
}

/// Warns on stderr, and in the JSON of the summary.
void tell(Warnings& warnings, const std::string& origin, const std::string& text) {
    spdlog::warn("{}: {}", origin, text);
    warnings.push_back(text);
}

/// Returns how many samples of a recording are simulated again, and warns of those that are not.
std::int64_t samples_again(std::int64_t last_sample, const Json& provenance, const std::string& origin,
                           Warnings& warnings) {
    const auto known = OutsideJson(provenance).count("changes_until_sample");
    if (!known || *known > last_sample) {
        return last_sample + 1;
    }
    tell(warnings, origin,
         fmt::format(
             "it was cut off; changes from sample {} on are not known, so the {} samples from there on "
             "are not simulated again",
             *known, last_sample + 1 - *known));
    return std::max<std::int64_t>(1, *known);
}

/// Returns the scene in a recording's provenance, or adds the fault.
std::optional<Scene> recorded_scene(const Json& provenance, const std::string& origin, Faults& faults) {
    const auto found = provenance.is_object() ? provenance.find("scene") : provenance.end();
    if (!provenance.is_object() || found == provenance.end() || !found->is_object()) {
        faults.add(origin, "found no scene in this recording, allowed: recordings of hertzline");
        return std::nullopt;
    }
    return faults.value_of(origin, scene_of_json(*found));
}

/// Resolves a recorded scene, which has integrator and step, with the accuracy that was asked for, where the program chooses the same
/// ones again. @param run_s how long the run was to last; none: as long as a stream
Resolution resolved_again(const Scene& scene, const Json& provenance, std::optional<double> run_s) {
    Json asked = scene_json(scene);
    asked["numerics"] = OutsideJson(provenance).at("asked_numerics");
    if (const auto open = scene_of_json(asked); open && !open->numerics.step_s) {
        Resolution resolved = hertzline::resolve(*open, run_s);
        if (resolved.faults.empty() && scene_hash(resolved.scene) == scene_hash(scene)) {
            return resolved;
        }
    }
    return hertzline::resolve(scene, run_s);
}

/// Adds and prints the warning of epochs that last longer than their errors were estimated over.
void warn_of_the_unwatched(Session& session, std::int64_t samples) {
    const double rate = session.resolved.scene.output.sample_rate_hz;
    std::optional<ErrorEstimate> estimate = session.resolved.estimate;
    std::int64_t begin = 0;
    for (std::size_t i = 0; i <= session.steps.size(); ++i) {
        const std::int64_t end = i < session.steps.size() ? session.steps[i].sample : samples;
        const double epoch_s = static_cast<double>(end - begin) / rate;
        const bool told = i == 0 && session.resolved.may_miss_accuracy();
        if (!told && estimate && estimate->over_s < epoch_s - 2 / rate) {
            session.warnings.push_back(fmt::format(
                "the error from sample {} on is estimated over the first {:.3g} s of {:.3g} s; what it grows "
                "to is not known",
                begin, estimate->over_s, epoch_s));
            spdlog::warn(session.warnings.back());
            return;
        }
        if (i < session.steps.size()) {
            begin = end;
            estimate = session.steps[i].estimate;
        }
    }
}

/// Returns the scene as it was in an epoch, before the changes up to it, or adds the faults.
std::optional<Scene> before_epoch(std::int64_t epoch, std::optional<Scene> scene,
                                  const std::vector<stream::SceneChange>& changes, const std::string& origin,
                                  Faults& faults) {
    if (epoch > 0 && (changes.empty() || changes.front().epoch != 1)) {
        faults.add(origin,
                   fmt::format("it begins in epoch {}, and does not hold all changes before it", epoch));
        return std::nullopt;
    }
    for (auto change = changes.rbegin(); scene && change != changes.rend(); ++change) {
        if (change->epoch <= epoch) {
            scene = faults.value_of(
                origin, with_values(*std::move(scene), change->was.is_null() ? Json::object() : change->was));
        }
    }
    return scene;
}

/// Returns the JSON of a file of changes, or adds the fault of reading it.
std::optional<Json> changes_file(const std::string& file, Faults& faults) {
    constexpr std::uint64_t largest = 64 << 20;
    try {
        recordings::InputFile input(file);
        Json json =
            json_from_outside(input.text(std::min(input.size(), largest), "the changes"), printable(file));
        return json.is_object() && json.contains("changes") ? json["changes"] : json;
    } catch (const std::runtime_error& error) {
        faults.add("--changes", error.what());
        return std::nullopt;
    }
}

/// Returns the index of the last sample.
std::int64_t last_sample(recordings::RecordingReader& reader) {
    constexpr std::size_t at_a_time = 4096;
    std::int64_t end = 0;
    const auto columns = static_cast<std::int64_t>(reader.head().columns.size());
    for (recordings::RecordedRows rows; reader.read(rows, at_a_time);) {
        end = rows.first + std::ssize(rows.values) / columns;
    }
    return std::max<std::int64_t>(0, end - 1);
}

/// Warns of another version or instruction set: the same bits need the same instructions.
void warn_of_differences(const Json& provenance, const std::string& origin, Warnings& warnings) {
    const auto differs = [&](const char* key, const std::string& here) {
        const std::string there = provenance.value(key, here);
        if (there != here) {
            tell(warnings, origin,
                 fmt::format("recorded with {} {}, here it is {}: the samples may differ in their last bits",
                             key, printable(there), here));
        }
    };
    differs("simd_target", kernels::kernel_target());
    differs("version", measures::program_version());
}

}  // namespace

std::optional<Session> session_of_recording(const SceneRequest& request, Faults& faults) {
    const std::string origin = printable_whole(request.scene);
    if (!request.settings.empty()) {
        faults.add("--set: found together with a recording, allowed: with a scene");
        return std::nullopt;
    }
    const std::unique_ptr<recordings::RecordingReader> reader = recordings::open_reader(request.scene);
    const Json& provenance = reader->head().provenance;
    std::optional<Scene> scene = recorded_scene(provenance, origin, faults);
    if (!scene) {
        return std::nullopt;
    }
    Session session;
    auto changes = recorded_changes(provenance, origin, faults);
    if (!changes) {
        return std::nullopt;
    }
    session.changes = *std::move(changes);
    // a listener that joined later has the scene of the epoch in which it did
    scene = before_epoch(provenance.value("epoch", std::int64_t{0}), std::move(scene), session.changes,
                         origin, faults);
    if (!scene) {
        return std::nullopt;
    }
    if (awaits_samples(scene->drive)) {
        faults.add(
            origin,
            "found a live drive without its samples, allowed: a recording of hertzline stream --record");
        return std::nullopt;
    }
    warn_of_differences(provenance, origin, session.warnings);
    std::int64_t samples = samples_again(last_sample(*reader), provenance, origin, session.warnings);
    const bool streamed = OutsideJson(provenance).at("run").is_string();  // without an end that was known
    const std::optional<double> run_s = streamed ? std::nullopt : std::optional(scene->output.duration_s);
    session.resolved = resolved_again(*scene, provenance, run_s);
    faults.add(origin, session.resolved.faults);
    if (!session.resolved.faults.empty()) {
        return std::nullopt;
    }
    for (const std::string& text : measures::scene_warnings(session.resolved)) {
        spdlog::warn("{}: {}", origin, text);
    }
    if (const Drive& drive = session.resolved.scene.drive; drive.kind == DriveKind::live && drive.file) {
        session.drive = std::make_shared<recordings::RecordedDrive>(
            fs::path(request.scene).parent_path() / *drive.file, session.resolved.scene,
            OutsideJson(provenance).text("run"));
        if (session.drive->output_samples() < samples) {
            tell(session.warnings, origin,
                 fmt::format("the input in {} ends early: the first {} of {} samples are simulated again",
                             printable(*drive.file), session.drive->output_samples(), samples));
            samples = session.drive->output_samples();
        }
    }
    while (!session.changes.empty() && session.changes.back().sample >= samples) {
        tell(session.warnings, origin,
             fmt::format("it ends before its change from sample {} on", session.changes.back().sample));
        session.changes.pop_back();
    }
    auto whole = with_steps(std::move(session), *scene, samples, origin, faults);
    if (whole) {
        whole->resolved.scene.output.duration_s =
            static_cast<double>(samples - 1) / scene->output.sample_rate_hz;
        warn_of_the_unwatched(*whole, samples);
    }
    return whole;
}

std::optional<Session> session_of_scene(const SceneRequest& request, const std::string& file,
                                        Faults& faults) {
    Warnings of_record;
    const auto parsed = faults.value_of({}, parsed_scene(request, &of_record));
    auto resolved = parsed ? faults.value_of({}, resolved_scene(*parsed)) : std::nullopt;
    if (!resolved) {
        return std::nullopt;
    }
    Session session{.resolved = *std::move(resolved), .changes = {}, .steps = {}, .warnings = {}};
    if (file.empty()) {
        session.warnings = std::move(of_record);
        return session;
    }
    const auto json = changes_file(file, faults);
    const std::string origin = "--changes " + printable(file);
    auto changes = json ? faults.value_of(origin, stream::changes_in(*json)) : std::nullopt;
    if (!changes) {
        return std::nullopt;
    }
    session.changes = *std::move(changes);
    const auto samples = static_cast<std::int64_t>(measures::rows_of_run(session.resolved.scene));
    if (!session.changes.empty() && session.changes.back().sample >= samples) {
        faults.add(origin,
                   fmt::format("found a change from sample {} on, allowed: up to {}, the last one of the run "
                               "(output.duration_s)",
                               session.changes.back().sample, samples - 1));
        return std::nullopt;
    }
    const Scene requested = session.resolved.requested();
    auto whole = with_steps(std::move(session), requested, samples, origin, faults);
    if (whole) {
        for (const std::string& text : whole->warnings) {
            spdlog::warn(text);
        }
        whole->warnings.insert(whole->warnings.begin(), of_record.begin(), of_record.end());
    }
    return whole;
}

}  // namespace hertzline::app
