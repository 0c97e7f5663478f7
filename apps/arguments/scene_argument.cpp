#include "apps/arguments/scene_argument.hpp"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <functional>
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
#include "core/scene/scene_json.hpp"
#include "core/scene/text.hpp"
#include "core/scene/toml_entries.hpp"
#include "hertzline/scene_file.hpp"
#include "hertzline/simulation.hpp"
#include "measures/measuring.hpp"
#include "measures/resources.hpp"
#include "recordings/drive_record.hpp"
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

/// The provenance of a recording; nothing where the name is no recording's. @throws std::runtime_error when it cannot be read
std::optional<Json> provenance_of_recording(const std::string& name) {
    std::error_code unknown;
    if (!std::filesystem::is_regular_file(name, unknown) ||
        recordings::recording_fault(name, recordings::Access::reading)) {
        return std::nullopt;
    }
    return recordings::open_reader(name)->head().provenance;
}

/// How many live changes a recording has after its first sample.
std::int64_t changes_after_the_beginning(const Json& provenance) {
    const auto epoch_of = [](const Json& json) { return OutsideJson(json).count("epoch").value_or(0); };
    return std::ranges::count_if(OutsideJson(provenance).at("changes"),
                                 [&](const Json& change) { return epoch_of(change) > epoch_of(provenance); });
}

/// The scene in a recording of hertzline as it was asked for, with its settings; nothing where the name is no recording's. Steps that
/// the program chose are chosen again: they suit no other scene. @param inform takes sentences about the recording
std::optional<tl::expected<ParsedScene, std::vector<Fault>>> scene_of_recording(
    const SceneRequest& request, const std::function<void(const std::string&)>& inform) {
    const auto fault = [&](const std::string& found, const std::string& allowed) {
        return tl::unexpected(std::vector{Fault{"", found, allowed, {printable(request.scene)}}});
    };
    try {
        const std::optional<Json> provenance = provenance_of_recording(request.scene);
        if (!provenance) {
            return std::nullopt;
        }
        Json scene = OutsideJson(*provenance).at("scene");
        if (!scene.is_object()) {
            return fault("no scene in this recording", "scenes, and recordings of hertzline");
        }
        if (const Json& asked = OutsideJson(*provenance).at("asked_numerics"); asked.is_object()) {
            scene["numerics"] = asked;
        }
        const auto recorded = scene_of_json(scene);
        if (!recorded) {
            return tl::unexpected(recorded.error());
        }
        const std::string origin = printable(request.scene);
        auto parsed = parse_scene(to_toml(*recorded), origin, request.settings);
        if (auto unread =
                parsed ? recordings::read_drive(*parsed, [](const std::string&) {}) : std::nullopt) {
            return tl::unexpected(std::vector{*std::move(unread)});
        }
        if (!parsed) {
            std::vector<Fault> faults = parsed.error();
            std::ranges::for_each(faults, [&](Fault& each) {
                each.place.line = each.place.origin == origin ? 0 : each.place.line;
            });
            return tl::unexpected(std::move(faults));
        }
        for (auto& [key, place] : parsed->places) {
            place.line = 0;  // of the text above, which no file has
        }
        if (const auto changes = changes_after_the_beginning(*provenance); changes > 0) {
            inform(
                fmt::format("{}: the scene is that of its beginning, without its {} changes, which hertzline "
                            "run repeats",
                            origin, changes));
        }
        return parsed;
    } catch (const std::runtime_error& error) {
        return fault(error.what(), "");
    }
}

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
        if (const std::optional<Json> provenance = provenance_of_recording(request.scene)) {
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

tl::expected<ParsedScene, std::vector<Fault>> parsed_scene(const SceneRequest& request) {
    if (auto recorded =
            scene_of_recording(request, [](const std::string& text) { spdlog::info("{}", text); })) {
        return *std::move(recorded);
    }
    return recordings::parse_scene_with_drive(
        request.scene, request.settings,
        [&](const std::string& warning) { spdlog::warn("{}: drive.file: {}", request.scene, warning); });
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
    const bool endless =
        lasting == Lasting::endless || (lasting == Lasting::as_driven && awaits_samples(parsed.scene.drive));
    Resolution resolved = endless ? hertzline::resolve(parsed.scene, std::nullopt, nullptr, usable_threads())
                                  : hertzline::resolve(parsed.scene, nullptr, usable_threads());
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

Resolution required_scene(const SceneRequest& request, Lasting lasting) {
    auto resolved = resolved_scene(request, lasting);
    if (!resolved) {
        throw WrongUse(fault_text(resolved.error()));
    }
    return *std::move(resolved);
}

}  // namespace hertzline::app
