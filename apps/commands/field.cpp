// hertzline field: the sound at the points of a plane, to a table.

#include "studies/field.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include "apps/arguments/options.hpp"
#include "apps/arguments/scene_argument.hpp"
#include "apps/command.hpp"
#include "apps/commands/sweep/study_session.hpp"
#include "apps/console/output.hpp"
#include "apps/console/progress.hpp"
#include "apps/console/signals.hpp"
#include "core/model/validity.hpp"
#include "core/scene/faults.hpp"
#include "core/scene/text.hpp"
#include "hertzline/spectrum.hpp"
#include "hertzline/taps.hpp"
#include "measures/provenance.hpp"
#include "measures/record_warnings.hpp"
#include "measures/resources.hpp"
#include "measures/run.hpp"
#include "recordings/files/staged_file.hpp"
#include "recordings/formats/table.hpp"
#include "recordings/recording_formats.hpp"
#include "studies/workers.hpp"

namespace hertzline::app {

namespace {

constexpr const char* field_examples =
    "Saves the peak, the rms and the harmonics of the pressure at each point of a plane, a line or a box, a "
    "row each, x fastest; "
    "plot draws them. With --waveforms an .h5 file holds the pressures themselves, p_points[point][sample], "
    "as float32, in the order that "
    "k-Wave gives the points of source.p_mask.\n"
    "Examples:\n"
    "  hertzline field wet-vitreous-carbon --plane x=-8mm..8mm:81,z=1mm..31mm:61 -o field.h5\n"
    "  hertzline plot field.h5 -o field.png --quantity peak_pa,harmonic_3_pa\n"
    "  hertzline field wet-vitreous-carbon --plane z=1mm..100mm:200:log -o axis.csv\n"
    "  hertzline field wet-vitreous-carbon --plane x=-5mm..5mm:51,y=-5mm..5mm:51,z=2mm --waveforms -o "
    "source.h5";

struct FieldOptions {
    SceneRequest scene;
    std::string plane;
    std::vector<std::string> files;
    std::optional<int> jobs;
    bool waveforms = false;
    Format format = Format::text;
};

/// Waveforms on disk until they are in order, in a file beside the table that ends with the program.
class Waveforms {
public:
    Waveforms(const std::string& table, std::size_t samples)
        : file_(table, recordings::StagedFile::Devices::refused), samples_(samples) {
        std::filesystem::remove(file_.temporary());  // it stays open
    }

    void put(std::size_t point, const std::vector<double>& pressure) {
        const std::vector<float> values(pressure.begin(), pressure.end());
        const auto bytes = std::as_bytes(std::span(values));
        if (const int error = recordings::write_all_at(file_.descriptor(), bytes, point * bytes.size())) {
            file_.fail(error);
        }
    }

    void get(std::size_t point, std::vector<float>& into) const {
        into.resize(samples_);
        const auto bytes = std::as_writable_bytes(std::span(into));
        for (std::size_t done = 0; done < bytes.size();) {
            const ssize_t got = ::pread(file_.descriptor(), bytes.data() + done, bytes.size() - done,
                                        static_cast<off_t>(point * bytes.size() + done));
            if (got <= 0) {
                throw std::runtime_error("cannot read the waveforms of " +
                                         printable_whole(file_.path().string()) + " back");
            }
            done += static_cast<std::size_t>(got);
        }
    }

private:
    recordings::StagedFile file_;
    std::size_t samples_;
};

std::vector<recordings::TableColumn> field_columns() {
    using recordings::CellKind;
    std::vector<recordings::TableColumn> columns{
        {{"point", "", ""}, CellKind::integer, sizeof(std::int64_t)}};
    for (const char* name : {"x_m", "y_m", "z_m"}) {
        columns.push_back({{name, "", "m"}});
    }
    columns.push_back({{"status", "", ""}, CellKind::text, studies::status_bytes});
    columns.push_back({{"peak_pa", "", "Pa"}});
    columns.push_back({{"rms_pa", "", "Pa"}});
    for (std::size_t k = 1; k <= SpectrumAnalyser::max_harmonics; ++k) {
        columns.push_back({{fmt::format("harmonic_{}_pa", k), "", "Pa"}});
    }
    return columns;
}

/// @throws std::runtime_error when the run is too long, the memory too small, or the disk for one of the files, or for the first one
/// and the waveforms beside it
void refuse_field_shortages(const FieldOptions& options, const Scene& scene, int jobs) {
    const auto points = static_cast<double>(scene.output.points_m.size());
    throw_if(measures::longest_run_fault(scene));
    const double numbers = points * static_cast<double>(field_columns().size() * sizeof(double));
    refuse_memory_shortage("a field", jobs, studies::field_memory_bytes(scene, jobs) + numbers);
    const std::size_t samples =
        options.waveforms ? static_cast<std::size_t>(measures::rows_of_run(scene)) : 0;
    double kept = points * static_cast<double>(samples * sizeof(float));
    for (const std::string& file : options.files) {
        const double bytes = recordings::table_bytes(file, field_columns(), points, samples);
        throw_if(measures::disk_shortage(file, bytes + std::exchange(kept, 0)));
    }
}

/// The numbers of each point, and what a table needs of them.
class FieldTable {
public:
    /// @param files beside the first of which waveforms are kept
    FieldTable(const studies::FieldGrid& grid, const Scene& scene, studies::PointStatus status,
               Json provenance, std::span<const std::string> files, bool waveforms)
        : grid_(grid),
          status_(status),
          numbers_(grid.size() * columns, std::numeric_limits<double>::quiet_NaN()),
          samples_(static_cast<std::size_t>(measures::rows_of_run(scene))) {
        if (waveforms) {
            table_.samples =
                recordings::TableSamples{std::string(row_of(Tap::p_points).name), "Pa", samples_};
        }
        table_.columns = field_columns();
        table_.rows = static_cast<std::int64_t>(grid.size());
        table_.provenance = std::move(provenance);
        table_.records = "points";
        table_.read = [this](std::int64_t row, recordings::TableRow& into) { read(row, into); };
        if (waveforms) {
            waveforms_ = std::make_unique<Waveforms>(files.front(), samples_);
        }
    }
    FieldTable(const FieldTable&) = delete;
    FieldTable& operator=(const FieldTable&) = delete;

    void put(const studies::FieldPoint& point) {
        double* const numbers = numbers_.data() + point.number * columns;
        numbers[0] = point.peak_pa;
        numbers[1] = point.rms_pa;
        std::ranges::copy(point.harmonics_pa, numbers + 2);
        if (waveforms_) {
            waveforms_->put(point.number, point.pressure_pa);
        }
    }

    const recordings::Table& table() const noexcept { return table_; }

    /// The number of the loudest point.
    std::size_t loudest() const noexcept {
        return first_of_least([&](std::size_t number) { return -peak_pa(number); });
    }
    double peak_pa(std::size_t point) const noexcept { return numbers_[point * columns]; }

    /// The number of the point that lies nearest to a place.
    std::size_t nearest_to(const std::vector<double>& place_m) const {
        return first_of_least([&](std::size_t number) {
            const studies::Point at = grid_.point(number);
            return std::hypot(at[0] - place_m[0], at[1] - place_m[1], at[2] - place_m[2]);
        });
    }

private:
    static constexpr std::size_t columns = 2 + SpectrumAnalyser::max_harmonics;

    template <class Measure>
    std::size_t first_of_least(Measure measure) const {
        std::size_t best = 0;
        for (std::size_t number = 1; number < grid_.size(); ++number) {
            best = measure(number) < measure(best) ? number : best;
        }
        return best;
    }

    void read(std::int64_t row, recordings::TableRow& into) {
        const auto number = static_cast<std::size_t>(row);
        const studies::Point at = grid_.point(number);
        into.cells = {row, at[0], at[1], at[2], std::string(studies::word_of(status_))};
        const double* const numbers = numbers_.data() + number * columns;
        into.cells.insert(into.cells.end(), numbers, numbers + columns);
        if (waveforms_) {
            waveforms_->get(number, into.samples);
        }
    }

    const studies::FieldGrid& grid_;
    studies::PointStatus status_;  // of each point: they have one motion
    std::vector<double> numbers_;
    std::size_t samples_;
    std::unique_ptr<Waveforms> waveforms_;
    recordings::Table table_;
};

struct CheckedField {
    ParsedScene parsed;
    studies::FieldGrid grid;
};

/// @throws WrongUse with every fault
CheckedField checked(const FieldOptions& options) {
    Faults faults;
    CheckedField result;
    if (auto parsed = faults.value_of({}, parsed_scene(options.scene))) {
        result.parsed = *std::move(parsed);
        Scene& scene = result.parsed.scene;
        if (!provides(scene, Requires::modal_plate)) {
            faults.add(
                "end.model: found a scene without a modal plate, allowed: end.model = \"modal\", which has "
                "sound");
        }
        if (auto grid = faults.value_of("--plane", studies::parse_grid(scene, options.plane))) {
            result.grid = *std::move(grid);
            scene.output.points_m.clear();
            for (std::size_t i = 0; i < result.grid.size(); ++i) {
                scene.output.points_m.push_back(result.grid.point(i));
            }
        }
    }
    recordings::Table like;
    like.columns = field_columns();
    if (options.waveforms) {
        like.samples = recordings::TableSamples{"p_points", "Pa", 1};
    }
    for (std::size_t i = 0; i < options.files.size(); ++i) {
        const auto fault = recordings::table_fault(options.files[i], like);
        faults.add(
            "-o",
            fault ? fault : recordings::repeated_fault(options.files[i], std::span(options.files).first(i)));
    }
    check_inputs_stay("-o", options.files, files_of(options.scene), faults);
    faults.add("--jobs", studies::jobs_fault(options.jobs.value_or(studies::usual_jobs())));
    faults.refuse<WrongUse>();
    return result;
}

Json provenance_of(Resolution resolved, const studies::FieldGrid& grid) {
    resolved.scene.output.points_m.clear();
    Json json = measures::provenance_json(resolved);
    json["plane"] = grid.text();
    return json;
}

Exit field(const FieldOptions& options) {
    using Clock = std::chrono::steady_clock;
    const CheckedField asked = checked(options);
    const int jobs = options.jobs.value_or(studies::usual_jobs());
    refuse_field_shortages(options, asked.parsed.scene, jobs);
    auto resolved = resolved_scene(asked.parsed);
    if (!resolved) {
        throw WrongUse(fault_text(resolved.error()));
    }
    const Scene& scene = resolved->scene;
    for (const std::string& file : options.files) {
        recordings::require_writable(file);
    }
    for (const auto& warnings : {measures::run_warnings(scene), late_sound_warnings(scene)}) {
        for (const std::string& text : warnings) {
            spdlog::warn("{}", text);
        }
    }
    stop_asked();  // from here on there are files to be cleaned up
    const studies::PointStatus status = studies::status_of(*resolved);
    FieldTable table(asked.grid, scene, status, provenance_of(*resolved, asked.grid), options.files,
                     options.waveforms);
    const Clock::time_point start = Clock::now();
    const auto elapsed_s = [start] { return std::chrono::duration<double>(Clock::now() - start).count(); };
    const std::size_t all = asked.grid.size();
    studies::PointCounts done;
    {
        ProgressLine line;
        studies::run_field(scene, jobs, stop_asked(), [&](const studies::FieldPoint& point) {
            table.put(point);
            ++done[status];
            if (line.due()) {
                line.show(progress_text(done, static_cast<std::int64_t>(all), elapsed_s()));
            }
        });
    }
    if (done.all() < static_cast<std::int64_t>(all)) {
        spdlog::error("stopped after {} of {} points; nothing was saved", done.all(), all);
        return Exit::failed;
    }
    for (const std::string& file : options.files) {
        if (!recordings::write_table(file, table.table(), stop_asked())) {
            spdlog::error("stopped before the end; {} was not saved", printable(file));
            return Exit::failed;
        }
    }
    const std::size_t loudest = table.loudest();
    Json summary{
        {"points", all}, {"largest_peak_pa", table.peak_pa(loudest)}, {"at_m", asked.grid.point(loudest)}};
    if (!scene.array.focus_m.empty()) {
        const std::size_t nearest = table.nearest_to(scene.array.focus_m);
        summary["peak_near_focus_pa"] = table.peak_pa(nearest);
        summary["near_focus_m"] = asked.grid.point(nearest);
    }
    summary["status"] = studies::word_of(status);
    summary["estimated_error"] = resolved->estimate ? Json(resolved->estimate->error) : Json(nullptr);
    summary["wall_s"] = elapsed_s();
    summary["files"] = options.files;
    print_summary(summary, options.format);
    return Exit::done;
}

}  // namespace

Run field_command(CLI::App& app) {
    auto options = std::make_shared<FieldOptions>();
    add_scene_options(app, options->scene)->required();
    app.add_option("--plane", options->plane,
                   "points by their coordinates from the centre of the disc, z along the axis: each a range "
                   "FROM..TO:COUNT, a list, or one "
                   "value; x or y that is left out is 0")
        ->required()
        ->type_name("x=..,y=..,z=..");
    add_repeatable_option(app, "-o,--output", options->files, "the table: .h5 or .csv; repeatable")
        ->check(missing_name)
        ->required()
        ->type_name("FILE");
    app.add_flag("--waveforms", options->waveforms,
                 "keep the pressures of all samples as float32, in .h5 only");
    app.add_option("--jobs", options->jobs, "threads (default: one for each usable processor)")
        ->type_name("N");
    add_target_option(app);
    add_format_option(app, options->format, "print the summary as one JSON object");
    app.footer(field_examples);
    return [options] { return field(*options); };
}

}  // namespace hertzline::app
