#include "apps/arguments/scene_argument.hpp"

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <stop_token>
#include <string>
#include <thread>
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

namespace {

/// Says what takes so long, where it takes more than a second.
class Notice {
public:
    explicit Notice(std::string text)
        : thread_([this, text = std::move(text)](const std::stop_token& stop) {
              std::unique_lock lock(mutex_);
              wake_.wait_for(lock, stop, std::chrono::seconds(1), [] { return false; });
              if (!stop.stop_requested()) {
                  spdlog::info("{}", text);
              }
          }) {}

private:
    std::mutex mutex_;
    std::condition_variable_any wake_;
    std::jthread thread_;  // last: it uses the others
};

}  // namespace

tl::expected<ParsedScene, std::vector<Fault>> parsed_scene(const SceneRequest& request) {
    return parse_scene_file(request.scene, request.settings);
}

tl::expected<Resolution, std::vector<Fault>> resolved_scene(const SceneRequest& request, Lasting lasting) {
    const auto parsed = parsed_scene(request);
    return parsed ? resolved_scene(*parsed, lasting)
                  : tl::expected<Resolution, std::vector<Fault>>(tl::unexpected(parsed.error()));
}

tl::expected<Resolution, std::vector<Fault>> resolved_scene(const ParsedScene& parsed, Lasting lasting) {
    if (const auto shortage = measures::memory_shortage("simulating " + parsed.origin,
                                                        Simulation::memory_bytes(parsed.scene, {}))) {
        throw std::runtime_error(*shortage);
    }
    std::optional<Notice> notice(parsed.origin + ": choosing the step by short simulations ...");
    Resolution resolved = lasting == Lasting::duration ? hertzline::resolve(parsed.scene)
                                                       : hertzline::resolve(parsed.scene, std::nullopt);
    notice.reset();
    if (!resolved.faults.empty()) {
        for (Fault& fault : resolved.faults) {
            fault = parsed.placed(fault);
        }
        return tl::unexpected(std::move(resolved.faults));
    }
    for (const std::string& text : measures::scene_warnings(resolved)) {
        spdlog::warn("{}: {}", parsed.origin, text);
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
