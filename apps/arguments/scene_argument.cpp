#include "apps/arguments/scene_argument.hpp"

#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <stdexcept>

#include "measures/resources.hpp"
#include "measures/run.hpp"
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "apps/arguments/options.hpp"
#include "apps/command.hpp"
#include "core/scene/shipped_scenes.hpp"
#include "core/scene/text.hpp"
#include "core/scene/toml_entries.hpp"
#include "core/simulation.hpp"

namespace hertzline::app {

namespace fs = std::filesystem;

namespace {

struct SceneText {
    std::string origin;  // as messages call it
    std::string text;
};

[[noreturn]] void refuse_name(const std::string& name) {
    std::vector<std::string> shipped;
    for (const ShippedScene& scene : shipped_scenes()) {
        shipped.emplace_back(scene.name);
    }
    const std::string stem = fs::path(name).stem().string();  // "paper-wal.toml" means a shipped one, too
    throw WrongUse(fmt::format("{}: found no such file or shipped scene, allowed: a file, or one of {}{}",
                               printable(name), comma_separated(shipped), suggestion(stem, shipped)));
}

[[noreturn]] void refuse_file(const std::string& name, int reason) {
    throw WrongUse(fmt::format("{}: cannot read the scene: {}", printable(name),
                               std::generic_category().message(reason)));
}

/// The whole file, or one byte more than is allowed: enough to refuse it.
std::string read_text(const std::string& name) {
    const auto close = [](std::FILE* file) { std::fclose(file); };
    const std::unique_ptr<std::FILE, decltype(close)> file(std::fopen(name.c_str(), "rbe"), close);
    if (file == nullptr) {
        refuse_file(name, errno);
    }
    std::string text(max_scene_bytes + 1, '\0');
    text.resize(std::fread(text.data(), 1, text.size(), file.get()));
    if (std::ferror(file.get()) != 0) {
        refuse_file(name, errno);
    }
    if (text.size() > max_scene_bytes) {
        throw WrongUse(fmt::format("{}: found more than {} bytes, allowed: at most {} bytes", printable(name),
                                   max_scene_bytes, max_scene_bytes));
    }
    return text;
}

SceneText find_text(const std::string& name) {
    std::error_code error;
    const fs::file_status status = fs::status(name, error);
    const bool file = fs::exists(status) && !fs::is_directory(status);
    if (!file) {
        if (const ShippedScene* shipped = find_shipped_scene(name)) {
            return {name, std::string(shipped->text)};
        }
    }
    if (status.type() == fs::file_type::none) {
        refuse_file(name, error.value());  // the name itself cannot be looked up
    }
    if (!fs::exists(status)) {
        refuse_name(name);
    }
    return {printable(name), read_text(name)};
}

[[noreturn]] void refuse_scene(const std::vector<Fault>& faults) {
    std::string text;
    for (const Fault& fault : faults) {
        text += (text.empty() ? "" : "\n") + fault.message();
    }
    throw WrongUse(text);
}

}  // namespace

CLI::Option* add_scene_options(CLI::App& app, SceneRequest& request) {
    add_repeatable_option(app, "--set", request.settings,
                          "override a key of the scene: section.key=value; repeatable")
        ->type_name("KEY=VALUE");
    return app.add_option("SCENE", request.scene, "a scene file, or the name of a shipped scene")
        ->type_name("");
}

ParsedScene parsed_scene(const SceneRequest& request) {
    const SceneText source = find_text(request.scene);
    auto parsed = parse_scene(source.text, source.origin, request.settings);
    if (!parsed) {
        refuse_scene(parsed.error());
    }
    return *std::move(parsed);
}

Resolution resolved_scene(const SceneRequest& request, Lasting lasting) {
    const ParsedScene parsed = parsed_scene(request);
    if (const auto shortage = measures::memory_shortage("simulating " + parsed.origin,
                                                        Simulation::memory_bytes(parsed.scene, {}))) {
        throw std::runtime_error(*shortage);
    }
    Resolution resolved = lasting == Lasting::duration ? hertzline::resolve(parsed.scene)
                                                       : hertzline::resolve(parsed.scene, std::nullopt);
    if (!resolved.faults.empty()) {
        for (Fault& fault : resolved.faults) {
            fault = parsed.placed(fault);
        }
        refuse_scene(resolved.faults);
    }
    for (const std::string& text : measures::scene_warnings(resolved)) {
        spdlog::warn("{}: {}", parsed.origin, text);
    }
    return resolved;
}

}  // namespace hertzline::app
