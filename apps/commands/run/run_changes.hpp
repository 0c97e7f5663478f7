#pragma once
// `run --changes` and `run RECORDING`: repeats a live session.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/arguments/scene_argument.hpp"
#include "core/scene/faults.hpp"
#include "hertzline/resolve.hpp"
#include "hertzline/run.hpp"
#include "recordings/recorded_drive.hpp"
#include "stream/control/scene_change.hpp"

namespace hertzline::app {

/// A scene and the changes that it went through.
struct Session {
    Resolution resolved;  ///< the first scene
    std::vector<stream::SceneChange> changes;
    std::vector<SceneStep> steps;  ///< the scenes of the changes
    Warnings warnings;  ///< of the drive's record, and of the accuracy after each change and of the whole
    std::shared_ptr<recordings::RecordedDrive> drive = nullptr;  ///< the samples of a live drive
};

/// Reads the session of a recording, from sample 0 to its last one, or adds the faults.
std::optional<Session> session_of_recording(const SceneRequest& request, Faults& faults);

/// Reads a scene and the changes of a file: a JSON list as recordings have it, or an object with "changes". Or adds the
/// faults. @param file empty: none
std::optional<Session> session_of_scene(const SceneRequest& request, const std::string& file, Faults& faults);

}  // namespace hertzline::app
