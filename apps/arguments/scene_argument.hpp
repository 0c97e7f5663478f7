#pragma once
// The SCENE argument and its --set options: from the command line to a scene that can be simulated.

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>
#include <tl/expected.hpp>

#include "core/scene/faults.hpp"
#include "core/scene/scene_key.hpp"
#include "hertzline/resolve.hpp"
#include "hertzline/scene.hpp"
#include "hertzline/scene_file.hpp"

namespace hertzline::app {

/// SCENE and --set as the user gave them.
struct SceneRequest {
    std::string scene;                  ///< a file, or a shipped scene's name
    std::vector<std::string> settings;  ///< "section.key=value"
};

/// Adds SCENE and --set to a subcommand. `request` must outlive the parsing.
CLI::Option* add_scene_options(CLI::App& app, SceneRequest& request);

/// The keys that scenes may have; those of the scene's own materials as of one with the name NAME.
std::vector<SceneKey> documented_keys();

/// The value of a key that a scene does not give: in TOML, or in words.
std::string default_text(const SceneKey& key);

/// The files that the scene is read from: its own, and the record that it names.
std::vector<std::string> files_of(const SceneRequest& request);

/// Adds a fault for each output that would take the place of an input. @param option of the outputs, as "-o"
void check_inputs_stay(std::string_view option, std::span<const std::string> outputs,
                       std::span<const std::string> inputs, Faults& faults);

/// Reads the scene as it was asked for, or returns its faults. Prints warnings about its record. @param warnings takes them, too
tl::expected<ParsedScene, std::vector<Fault>> parsed_scene(const SceneRequest& request,
                                                           std::vector<std::string>* warnings = nullptr);

/// Threads for the chains of an array: one for each usable processor.
std::size_t usable_threads();

/// The stretch over which the error of a scene is estimated: a run of output.duration_s, or the pilots' stretch of an
/// endless motion; or one of them as the drive is, which is endless when it is live.
enum class Lasting { duration, endless, as_driven };

/// Settles integrator and step of the scene, or returns its faults. Warns where the requested accuracy is out of reach.
/// Takes as long as the pilot runs of core/step_choice do. @throws std::runtime_error when there is too little memory
tl::expected<Resolution, std::vector<Fault>> resolved_scene(const ParsedScene& parsed,
                                                            Lasting lasting = Lasting::duration);
tl::expected<Resolution, std::vector<Fault>> resolved_scene(const SceneRequest& request,
                                                            Lasting lasting = Lasting::duration);

/// Returns the resolved scene. @throws WrongUse with every fault, and as resolved_scene()
Resolution required_scene(const SceneRequest& request, Lasting lasting = Lasting::duration);

}  // namespace hertzline::app
