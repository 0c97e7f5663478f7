#pragma once
// A change of a scene that is being streamed: what is set, and from which sample on. A list of them makes a run again.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <tl/expected.hpp>

#include "core/scene/json.hpp"
#include "core/scene/scene.hpp"
#include "core/taps.hpp"

namespace hertzline::stream {

/// As replies have it.
Json faults_json(const std::vector<Fault>& faults);

/// Whether the motion goes on when one scene becomes the other: drives and steps may differ, the horn's material may not. Else it
/// begins anew at static equilibrium. Of resolved scenes.
bool motion_goes_on(const Scene& from, const Scene& to);

/// What cannot change while samples are streamed, because it changes what frames hold.
std::vector<Fault> frame_faults(const Scene& from, const Scene& to);

/// A change as it took effect, or shall.
struct SceneChange {
    std::int64_t sample = 0;  ///< the first one of the epoch that begins with it
    std::int64_t epoch = 0;   ///< its number, from 1
    Json set;                 ///< values by key; of a change that took effect with integrator and step
    Json was = nullptr;       ///< the values before; null: not known
    bool goes_on = false;     ///< the motion goes on
    std::string scene_hash;   ///< of the scene with integrator and step; empty: not known
};

/// The values that make one resolved scene of another: those that were asked for, then integrator, step and accuracy.
Json values_of_change(const Scene& to, const Json& asked);

Json change_json(const SceneChange& change);

/// The changes in a JSON list, in the order of their samples, or what is wrong with it.
tl::expected<std::vector<SceneChange>, std::string> changes_in(const Json& list);

}  // namespace hertzline::stream
