#include "apps/arguments/scene_argument.hpp"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <filesystem>
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
#include "core/model/drive.hpp"
#include "core/scene/text.hpp"
#include "core/scene/toml_entries.hpp"
#include "hertzline/scene_file.hpp"
#include "hertzline/simulation.hpp"
#include "measures/measuring.hpp"
#include "measures/resources.hpp"
#include "recordings/drive_record.hpp"
#include "recordings/named_scene.hpp"
#include "recordings/recording_formats.hpp"

namespace hertzline::app {

CLI::Option* add_scene_options(CLI::App& app, SceneRequest& request) {
    add_repeatable_option(app, "--set", request.settings,
                          "override a key of the scene: section.key=value; repeatable")
        ->type_name("KEY=VALUE");
    return app.add_option("SCENE", request.scene, "a scene file, or the name of a shipped scene")
        ->type_name("");
}

std::vector<SceneKey> documented_keys() {
    const auto all = scene_keys();
    std::vector<SceneKey> keys(all.begin(), all.end());
    for (const Material& material : {Material(Solid{}), Material(Fluid{})}) {
        for (const SceneKey& key : material_keys("NAME", material)) {
            if (std::ranges::find(keys, key.name, &SceneKey::name) == keys.end()) {
                keys.push_back(key);
            }
        }
    }
    return keys;
}

std::string default_text(const SceneKey& key) {
    if (const auto value = key.value(Scene{})) {
        return toml_text(*value);
    }
    return key.owner && !key.is_optional ? "needed" : std::string(key.traits.unset);
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

std::vector<std::string> files_of(const SceneRequest& request) {
    std::vector<std::string> files{request.scene};
    constexpr std::string_view record = "drive.file=";
    for (const std::string& setting : request.settings) {
        if (setting.starts_with(record)) {
            files.push_back(setting.substr(record.size()));
        }
    }
    try {
        if (const std::optional<Json> provenance = recordings::provenance_of(request.scene)) {
            if (const std::string drive = OutsideJson(*provenance).text("scene/drive/file"); !drive.empty()) {
                files.push_back((std::filesystem::path(request.scene).parent_path() / drive).string());
            }
            return files;
        }
    } catch (const std::runtime_error&) {
        return files;  // it cannot be read at all
    }
    if (const auto parsed = parse_scene_file(request.scene, request.settings)) {
        if (const auto file = recordings::record_of(*parsed)) {
            files.push_back(file->string());
        }
    }
    return files;
}

void check_inputs_stay(std::string_view option, std::span<const std::string> outputs,
                       std::span<const std::string> inputs, Faults& faults) {
    for (const std::string& output : outputs) {
        for (const std::string& input : inputs) {
            if (recordings::share_files(output, input)) {
                faults.add(fmt::format("{} {}", option, printable(output)),
                           "found a file that is read here, allowed: another file");
                break;
            }
        }
    }
}

std::size_t usable_threads() {
    return static_cast<std::size_t>(measures::usable_processors());
}

tl::expected<ParsedScene, std::vector<Fault>> parsed_scene(const SceneRequest& request,
                                                           std::vector<std::string>* warnings) {
    return recordings::parse_named_scene(request.scene, request.settings, [=](const std::string& warning) {
        spdlog::warn("{}", warning);
        if (warnings != nullptr) {
            warnings->push_back(warning);
        }
    });
}

tl::expected<Resolution, std::vector<Fault>> resolved_scene(const SceneRequest& request, Lasting lasting) {
    const auto parsed = parsed_scene(request);
    return parsed ? resolved_scene(*parsed, lasting)
                  : tl::expected<Resolution, std::vector<Fault>>(tl::unexpected(parsed.error()));
}

tl::expected<Resolution, std::vector<Fault>> resolved_scene(const ParsedScene& parsed, Lasting lasting) {
    if (const auto shortage = measures::memory_shortage("simulating " + printable_whole(parsed.origin),
                                                        Simulation::memory_bytes(parsed.scene, {}))) {
        throw std::runtime_error(*shortage);
    }
    std::optional<Notice> notice(printable_whole(parsed.origin) +
                                 ": choosing the step by short simulations ...");
    const bool endless =
        lasting == Lasting::endless || (lasting == Lasting::as_driven && awaits_samples(parsed.scene.drive));
    const auto run_s = endless ? std::nullopt : std::optional(parsed.scene.output.duration_s);
    Resolution resolved = hertzline::resolve(parsed.scene, run_s, nullptr, usable_threads());
    notice.reset();
    if (!resolved.faults.empty()) {
        for (Fault& fault : resolved.faults) {
            fault = parsed.placed(fault);
        }
        return tl::unexpected(std::move(resolved.faults));
    }
    for (const std::string& text : measures::scene_warnings(resolved)) {
        spdlog::warn("{}: {}", printable_whole(parsed.origin), text);
    }
    return resolved;
}

Resolution required_scene(const SceneRequest& request, Lasting lasting) {
    auto resolved = resolved_scene(request, lasting);
    if (!resolved) {
        throw WrongUse(fault_text(resolved.error()));
    }
    return *std::move(resolved);
}

}  // namespace hertzline::app
