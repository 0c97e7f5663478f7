#pragma once
// Where samples come from: all that is needed to make the same bits again. Part of every recording and of the topic meta.

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "core/model/bursts.hpp"
#include "core/scene/json.hpp"
#include "hertzline/resolve.hpp"

namespace hertzline::measures {

const char* program_version() noexcept;

/// The commit that was built, with "-dirty" when files differed from it; "unknown" without git.
const char* git_hash() noexcept;

/// The compiler and its version.
const char* compiler() noexcept;

/// UTC as ISO 8601 with milliseconds: "2026-01-31T12:00:00.123Z".
std::string utc_text(std::chrono::system_clock::time_point time);

/// The origin of numbers, whose bits depend on it: program, version, git_hash, compiler, simd_target.
Json maker_json();

/// Adds estimated_error and estimated_over_s; null: unknown.
void add_estimate(Json& json, const std::optional<ErrorEstimate>& estimate);

/// The origin of samples that are simulated from now on: maker_json(), start_time, run (if any), scene_hash, integrator,
/// step_s, estimated_error and estimated_over_s (null: unknown), asked_numerics, scene. @param run its id; unset: it has none
Json provenance_json(const Resolution& resolved, const std::optional<std::string>& run = {});

/// The provenance in a message of the topic meta: those of the keys above that it has.
Json provenance_of_meta(const Json& meta);

/// drive.repetition_hz of the scene in this provenance [Hz], 0 for a single burst; nothing when it holds no scene.
std::optional<double> repetition_of(const Json& provenance);

/// The epochs in a run's provenance: the one of its first samples, and those that "changes" began
/// later; none when it holds no scene.
std::vector<Epoch> epochs_of(const Json& provenance, double sample_rate_hz);

/// Adds the epoch that the change began to those before, at least one.
void add_epoch(std::vector<Epoch>& epochs, const Json& change, double sample_rate_hz);

}  // namespace hertzline::measures
