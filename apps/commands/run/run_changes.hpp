#pragma once
// `run --changes` and `run RECORDING`: repeats a live session.

#include <string>
#include <vector>

#include "measures/run.hpp"

#include "apps/arguments/scene_argument.hpp"
#include "core/step_choice/resolve.hpp"
#include "stream/control/scene_change.hpp"

namespace hertzline::app {

/// A scene and the changes that it went through.
struct Session {
    Resolution resolved;  ///< the first scene
    std::vector<stream::SceneChange> changes;
    std::vector<measures::SceneStep> steps;  ///< the scenes of the changes
};

/// Whether SCENE names a recording: an ending of one, and a file that is there.
bool is_recording(const std::string& scene);

/// The session that a recording holds, from sample 0 to its last one. @throws WrongUse when it lacks its scene
Session session_of_recording(const SceneRequest& request);

/// A scene with the changes of a file: a JSON list as recordings have it, or an object with "changes".
/// @param file empty: none @throws WrongUse with the fault
Session session_of_scene(const SceneRequest& request, const std::string& file);

}  // namespace hertzline::app
