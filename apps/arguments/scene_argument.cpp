#include "apps/arguments/scene_argument.hpp"

#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <stdexcept>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "apps/arguments/options.hpp"
#include "apps/command.hpp"
#include "core/model/chain.hpp"
#include "core/model/validity.hpp"
#include "core/scene/scene_toml.hpp"
#include "core/scene/shipped_scenes.hpp"
#include "core/scene/text.hpp"
#include "core/scene/toml_entries.hpp"
#include "core/simulation.hpp"
#include "stream/resources.hpp"

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

void warn_of_missed_accuracy(const std::string& origin, const ResolvedScene& resolved) {
    if (!resolved.misses_accuracy()) {
        return;
    }
    const double asked = resolved.advice.accuracy;
    if (!resolved.estimate) {
        spdlog::warn("{}: the error could not be estimated; requested: {:g}", origin, asked);
        return;
    }
    const ErrorEstimate& estimate = *resolved.estimate;
    spdlog::warn(
        "{}: the estimated error over the first {:.3g} s is {:.2g}, above the requested accuracy of {:g}{}",
        origin, estimate.over_s, estimate.error, asked,
        estimate.amplifies
            ? "; the motion amplifies rounding errors, so that no step is good enough: judge it "
              "by energy_residual and statistics, not sample by sample"
            : "");
}

}  // namespace

CLI::Option* add_scene_options(CLI::App& app, SceneRequest& request) {
    add_repeatable_option(app, "--set", request.settings,
                          "override a key of the scene: section.key=value; repeatable")
        ->type_name("KEY=VALUE");
    return app.add_option("SCENE", request.scene, "a scene file, or the name of a shipped scene")
        ->type_name("");
}

ResolvedScene resolved_scene(const SceneRequest& request, Lasting lasting) {
    const SceneText source = find_text(request.scene);
    const auto parsed = parse_scene(source.text, source.origin, request.settings);
    if (!parsed) {
        refuse_scene(parsed.error());
    }
    if (const auto shortage = stream::memory_shortage("simulating " + source.origin,
                                                      Simulation::memory_bytes(parsed->scene, {}))) {
        throw std::runtime_error(*shortage);
    }
    ResolvedScene resolved = lasting == Lasting::duration ? hertzline::resolve(parsed->scene)
                                                          : hertzline::resolve(parsed->scene, std::nullopt);
    if (!resolved.faults.empty()) {
        for (Fault& fault : resolved.faults) {
            fault = parsed->placed(fault);
        }
        refuse_scene(resolved.faults);
    }
    for (const std::string& text : validity_warnings(resolved.scene, Chain(resolved.scene))) {
        spdlog::warn("{}: {}", source.origin, text);
    }
    warn_of_missed_accuracy(source.origin, resolved);
    return resolved;
}

}  // namespace hertzline::app
