// hertzline check: whether a scene can be simulated, and what follows from it.

#include <memory>
#include <string>

#include <fmt/format.h>

#include "apps/arguments/scene_argument.hpp"
#include "apps/command.hpp"
#include "apps/commands/check/scene_report.hpp"
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

std::string shown(const ReportRow& row) {
    struct Shown {
        const std::string& unit;
        std::string operator()(std::monostate) const { return "-"; }
        std::string operator()(bool yes) const { return yes ? "yes" : "no"; }
        std::string operator()(const std::string& text) const { return text; }
        std::string operator()(std::int64_t number) const { return (*this)(static_cast<double>(number)); }
        std::string operator()(double number) const {
            return unit == "bytes" ? stream::human_bytes(number)
                                   : fmt::format("{:.6g}{}{}", number, unit.empty() ? "" : " ", unit);
        }
    };
    return std::visit(Shown{row.unit}, row.value);
}

std::string as_text(const std::vector<ReportRow>& report) {
    std::string text;
    std::string group;
    for (const ReportRow& row : report) {
        const std::string heading = row.group == group ? "" : row.group;
        group = row.group;
        text += fmt::format("{:<10}{:<32}{}\n", heading, row.label, shown(row));
    }
    return text;
}

Json as_json(const std::vector<ReportRow>& report) {
    struct Converted {
        Json operator()(std::monostate) const { return nullptr; }
        Json operator()(bool yes) const { return yes; }
        Json operator()(const std::string& text) const { return text; }
        Json operator()(std::int64_t number) const { return number; }
        Json operator()(double number) const { return number; }
    };
    Json json;
    for (const ReportRow& row : report) {
        json[row.name] = std::visit(Converted{}, row.value);
    }
    return json;
}

Exit check(const CheckOptions& options) {
    const std::vector<ReportRow> report = scene_report(resolved_scene(options.scene));
    print(options.format == Format::json ? json_text(as_json(report)) + '\n' : as_text(report));
    return Exit::done;
}

}  // namespace

Run check_command(CLI::App& app) {
    auto options = std::make_shared<CheckOptions>();
    add_scene_options(app, options->scene)->required();
    add_format_option(app, options->format, "print one JSON object, names with their units");
    app.footer(examples);
    return [options] { return check(*options); };
}

}  // namespace hertzline::app
