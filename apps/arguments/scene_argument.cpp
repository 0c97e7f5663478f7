#include "apps/arguments/scene_argument.hpp"

#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "apps/arguments/options.hpp"
#include "apps/command.hpp"
#include "hertzline/scene_file.hpp"
#include "hertzline/simulation.hpp"
#include "measures/resources.hpp"
#include "measures/run.hpp"

namespace hertzline::app {

CLI::Option* add_scene_options(CLI::App& app, SceneRequest& request) {
    add_repeatable_option(app, "--set", request.settings,
                          "override a key of the scene: section.key=value; repeatable")
        ->type_name("KEY=VALUE");
    return app.add_option("SCENE", request.scene, "a scene file, or the name of a shipped scene")
        ->type_name("");
}

tl::expected<ParsedScene, std::vector<Fault>> parsed_scene(const SceneRequest& request) {
    return parse_scene_file(request.scene, request.settings);
}

tl::expected<Resolution, std::vector<Fault>> resolved_scene(const SceneRequest& request, Lasting lasting) {
    const auto parsed = parsed_scene(request);
    if (!parsed) {
        return tl::unexpected(parsed.error());
    }
    if (const auto shortage = measures::memory_shortage("simulating " + parsed->origin,
                                                        Simulation::memory_bytes(parsed->scene, {}))) {
        throw std::runtime_error(*shortage);
    }
    Resolution resolved = lasting == Lasting::duration ? hertzline::resolve(parsed->scene)
                                                       : hertzline::resolve(parsed->scene, std::nullopt);
    if (!resolved.faults.empty()) {
        for (Fault& fault : resolved.faults) {
            fault = parsed->placed(fault);
        }
        return tl::unexpected(std::move(resolved.faults));
    }
    for (const std::string& text : measures::scene_warnings(resolved)) {
        spdlog::warn("{}: {}", parsed->origin, text);
    }
    return resolved;
}

Resolution required_scene(const SceneRequest& request) {
    auto resolved = resolved_scene(request);
    if (!resolved) {
        throw WrongUse(fault_text(resolved.error()));
    }
    return *std::move(resolved);
}

}  // namespace hertzline::app
