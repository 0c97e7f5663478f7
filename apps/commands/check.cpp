// hertzline check: validates a scene and reports its properties.

#include <algorithm>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "apps/arguments/scene_argument.hpp"
#include "apps/command.hpp"
#include "apps/commands/preflight.hpp"
#include "apps/commands/publish_session.hpp"
#include "apps/console/output.hpp"
#include "core/scene/text.hpp"
#include "hertzline/scene_file.hpp"
#include "measures/resources.hpp"
#include "measures/scene_report.hpp"
#include "stream/inputs/simulation_source.hpp"
#include "stream/pipeline/pipeline.hpp"

namespace hertzline::app {

namespace {

using measures::ReportRow;

constexpr const char* check_examples =
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
            return unit == "bytes" ? measures::human_bytes(number)
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
        text += fmt::format("{:<10}{:<34}{}\n", heading, row.label, shown(row));
    }
    return text;
}

/// Adds memory and disk of a run and of a stream of the scene.
void add_costs(std::vector<ReportRow>& report, const Scene& scene) {
    const auto count = measures::report_count;
    const double rows = rows_of_run(scene);
    const TapSet recorded = recorded_taps(scene);
    report.push_back({"run", "rows", "rows", "", count(rows)});
    report.push_back({"run", "memory, at most", "run_memory_bytes", "bytes",
                      count(memory_of_recorded_run(scene, recorded, {}))});
    const auto csv_bytes = [&](TapSet taps) { return file_bytes(scene, rows, "run.csv", taps); };
    report.push_back({"run", "CSV file, at most", "csv_bytes", "bytes", count(csv_bytes(recorded))});
    report.push_back({"run", "CSV file of --all, at most", "csv_all_bytes", "bytes",
                      count(csv_bytes(recorded | Tap::v_chain | Tap::x_chain))});
    report.push_back(
        {"run", "memory of a stream, at most", "stream_memory_bytes", "bytes",
         count(stream::SimulationSource::memory_bytes(scene) +
               stream_bytes(stream::SimulationSource::format_of(scene), stream::Pace::realtime(),
                            publisher_options(PublishRequest(), stream::SimulationSource::format_of(scene),
                                              std::nullopt)))});
    report.push_back({"run", "more for each of its recordings", "stream_recording_memory_bytes", "bytes",
                      count(memory_of_recordings(scene, recorded, 1))});
    report.push_back({"run", "scene hash", "scene_hash", "", scene_hash(scene)});
}

Exit check(const CheckOptions& options) {
    const Resolution resolved = required_scene(options.scene, Lasting::as_driven);
    const Scene& scene = resolved.scene;
    const auto peaks =
        measures::peak_overlaps(scene, std::min(scene.output.duration_s, measures::first_burst_s(scene)));
    for (const std::string& text : measures::check_warnings(scene, peaks)) {
        spdlog::warn("{}: {}", printable(options.scene.scene), text);
    }
    std::vector<ReportRow> report = measures::scene_report(resolved, peaks);
    add_costs(report, scene);
    print(options.format == Format::json ? json_text(measures::report_json(report)) + '\n' : as_text(report));
    return Exit::done;
}

}  // namespace

Run check_command(CLI::App& app) {
    auto options = std::make_shared<CheckOptions>();
    add_scene_options(app, options->scene)->required();
    add_format_option(app, options->format, "print one JSON object, names with their units");
    app.footer(check_examples);
    return [options] { return check(*options); };
}

}  // namespace hertzline::app
