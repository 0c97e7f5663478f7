// hertzline check: whether a scene can be simulated, and what follows from it.

#include <memory>
#include <string>

#include <fmt/format.h>

#include "apps/arguments/scene_argument.hpp"
#include "apps/command.hpp"
#include "apps/commands/scene_report.hpp"
#include "apps/console/output.hpp"
#include "stream/resources.hpp"

namespace hertzline::app {

namespace {

constexpr const char* examples =
    "Examples:\n"
    "  hertzline check my-scene.toml\n"
    "  hertzline check paper-wall --set numerics.accuracy=1e-6\n"
    "  hertzline check sonic-vacuum --json";

struct CheckOptions {
    SceneRequest scene;
    Format format = Format::text;
};

std::string shown(const DerivedValue& derived) {
    struct Shown {
        const std::string& unit;
        std::string operator()(std::monostate) const { return "-"; }
        std::string operator()(bool yes) const { return yes ? "yes" : "no"; }
        std::string operator()(const std::string& text) const { return text; }
        std::string operator()(double number) const {
            return unit == "bytes" ? stream::human_bytes(number)
                                   : fmt::format("{:.6g}{}{}", number, unit.empty() ? "" : " ", unit);
        }
    };
    return std::visit(Shown{derived.unit}, derived.value);
}

std::string as_text(const std::vector<DerivedValue>& values) {
    std::string text;
    std::string group;
    for (const DerivedValue& derived : values) {
        const std::string heading = derived.group == group ? "" : derived.group;
        group = derived.group;
        text += fmt::format("{:<10}{:<32}{}\n", heading, derived.label, shown(derived));
    }
    return text;
}

Json as_json(const std::vector<DerivedValue>& values) {
    struct Converted {
        Json operator()(std::monostate) const { return nullptr; }
        Json operator()(bool yes) const { return yes; }
        Json operator()(const std::string& text) const { return text; }
        Json operator()(double number) const { return number; }
    };
    Json json;
    for (const DerivedValue& derived : values) {
        json[derived.name] = std::visit(Converted{}, derived.value);
    }
    return json;
}

Exit check(const CheckOptions& options) {
    const std::vector<DerivedValue> values = derived_values(resolved_scene(options.scene));
    print(options.format == Format::json ? json_text(as_json(values)) + '\n' : as_text(values));
    return Exit::done;
}

}  // namespace

Command check_command(CLI::App& program) {
    auto options = std::make_shared<CheckOptions>();
    CLI::App* command = program.add_subcommand(
        "check", "validate a scene; print what follows from it and advice on its step");
    add_scene_options(*command, options->scene)->required();
    add_format_option(*command, options->format, "print one JSON object, names with their units");
    command->footer(examples);
    return {command, [options] { return check(*options); }};
}

}  // namespace hertzline::app
