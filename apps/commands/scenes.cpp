// hertzline scenes: the shipped scenes, one scene with every default resolved, or the keys of all scenes.

#include <algorithm>
#include <memory>
#include <string>

#include <fmt/format.h>

#include "apps/arguments/scene_argument.hpp"
#include "apps/command.hpp"
#include "apps/console/output.hpp"
#include "core/scene/scene_json.hpp"
#include "core/scene/scene_key.hpp"
#include "core/scene/text.hpp"
#include "hertzline/scene_file.hpp"

namespace hertzline::app {

namespace {

constexpr const char* scenes_examples =
    "Examples:\n"
    "  hertzline scenes\n"
    "  hertzline scenes paper-wall > my-scene.toml\n"
    "  hertzline scenes paper-wall --set chain.spheres=7 --json\n"
    "  hertzline scenes --keys";

struct ScenesOptions {
    SceneRequest scene;
    bool keys = false;
    bool unresolved = false;
    Format format = Format::text;
};

void list_scenes(Format format) {
    Json list = Json::array();
    std::string text;
    std::size_t width = 0;
    for (const ShippedScene& scene : shipped_scenes()) {
        width = std::max(width, scene.name.size());
    }
    for (const ShippedScene& scene : shipped_scenes()) {
        list.push_back({{"name", scene.name}, {"description", scene.description}});
        text += fmt::format("{:<{}}  {}\n", scene.name, width, scene.description);
    }
    print_listing(format == Format::json ? json_text(list) + '\n' : text);
}

/// Returns a row of the tables in scenes/README.md.
std::string key_row(const SceneKey& key) {
    const std::string text = default_text(key);
    const std::string standard = key.value(Scene{}) ? '`' + text + '`' : text;
    return fmt::format("| `{}` | {} | {} | {} |\n", key.name, standard, key.allowed(), key.doc);
}

void list_keys(Format format) {
    if (format == Format::json) {
        print_listing(json_text(scene_schema()) + '\n');
        return;
    }
    std::string text = "| key | default | allowed |  |\n|---|---|---|---|\n";
    for (const SceneKey& key : documented_keys()) {
        text += key_row(key);
    }
    print_listing(text);
}

/// Writes a scene file with the error of its step.
std::string annotated_toml(const Resolution& resolved, const SceneRequest& request) {
    return fmt::format("# {} with every default resolved; step_s was {}: estimated relative error {}\n\n{}",
                       printable(request.scene),
                       resolved.step_set_by_scene ? "given" : "chosen by the program",
                       resolved.estimate ? fmt::format("{:.1e}", resolved.estimate->error) : "unknown",
                       to_toml(resolved.scene));
}

Exit scenes(const ScenesOptions& options) {
    if (options.keys) {
        if (!options.scene.scene.empty() || !options.scene.settings.empty()) {
            throw WrongUse(
                "--keys: found a SCENE or --set, allowed: neither, since all scenes have the same keys");
        }
        list_keys(options.format);
        return Exit::done;
    }
    if (options.scene.scene.empty()) {
        if (!options.scene.settings.empty()) {
            throw WrongUse("--set needs a SCENE");
        }
        if (options.unresolved) {
            throw WrongUse("--unresolved needs a SCENE");
        }
        list_scenes(options.format);
        return Exit::done;
    }
    if (options.unresolved) {
        const auto parsed = parsed_scene(options.scene);
        if (!parsed) {
            throw WrongUse(fault_text(parsed.error()));
        }
        print_listing(options.format == Format::json ? json_text(scene_json(parsed->scene)) + '\n'
                                                     : to_toml(parsed->scene));
        return Exit::done;
    }
    const Resolution resolved = required_scene(options.scene);
    print_listing(options.format == Format::json ? json_text(scene_json(resolved.scene)) + '\n'
                                                 : annotated_toml(resolved, options.scene));
    return Exit::done;
}

}  // namespace

Run scenes_command(CLI::App& app) {
    auto options = std::make_shared<ScenesOptions>();
    add_scene_options(app, options->scene);
    app.add_flag("--keys", options->keys,
                 "list the keys of scenes: defaults, bounds and meanings; with --json as a schema");
    app.add_flag("--unresolved", options->unresolved,
                 "leave open what the program chooses: integrator, step, poles of a modal plate");
    add_format_option(app, options->format, "print JSON");
    app.footer(scenes_examples);
    return [options] { return scenes(*options); };
}

}  // namespace hertzline::app
