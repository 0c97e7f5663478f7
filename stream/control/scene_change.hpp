#pragma once
// A change of a scene that is being streamed: values, and the sample from which they apply. A list of changes repeats a run.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <tl/expected.hpp>

#include "core/scene/json.hpp"
#include "hertzline/resolve.hpp"
#include "hertzline/scene.hpp"
#include "hertzline/taps.hpp"
#include "measures/run.hpp"

namespace hertzline::stream {

/// Returns the faults as replies have them.
Json faults_json(const std::vector<Fault>& faults);

using measures::motion_goes_on;

/// Whether no stream can change the key, whatever its value.
bool is_fixed(std::string_view key) noexcept;

/// Returns the changes that a stream cannot make, because its frames depend on these values, or a record was read by them.
std::vector<Fault> frame_faults(const Scene& from, const Scene& to);

/// Simulated seconds in a second of work that are to be expected of a scene, roughly.
double expected_real_time_factor(const Resolution& resolved);
/// Below this a stream nearly stops.
inline constexpr double least_real_time_factor = 0.01;
/// Returns "a real-time factor of about 2e-08".
std::string real_time_factor_text(double factor);

/// A change as it took effect, or shall.
struct SceneChange {
    std::int64_t sample = 0;  ///< the first one of the epoch that begins with it
    std::int64_t epoch = 0;   ///< its number, from 1
    Json set;                 ///< values by key; of a change that took effect with integrator and step
    Json was = nullptr;       ///< the values before; null: not known
    bool goes_on = false;     ///< the motion continues; of a change that shall take effect: it may
    bool must_go_on = false;  ///< of a change that shall take effect: its author wants the motion to continue
    std::string scene_hash;   ///< of the scene with integrator and step; empty: not known
    std::optional<ErrorEstimate> estimate{};  ///< of its error; unset: not known
};

/// Returns the values that turn one resolved scene into another: those requested, then integrator, step and accuracy.
Json values_of_change(const Scene& to, const Json& asked);

Json change_json(const SceneChange& change);

/// Reads the changes of a JSON list, in the order of their samples, or returns its fault. Two changes may have the same sample if the
/// second one's motion begins anew: the first one's scene gave no samples and was given up.
tl::expected<std::vector<SceneChange>, std::string> changes_in(const Json& list);

}  // namespace hertzline::stream
