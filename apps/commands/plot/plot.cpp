// hertzline plot: a picture of recordings, of a sweep or of a field.

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "apps/arguments/options.hpp"
#include "apps/command.hpp"
#include "apps/commands/plot/picture.hpp"
#include "apps/console/signals.hpp"
#include "core/scene/scene_key.hpp"
#include "core/scene/text.hpp"
#include "core/scene/units.hpp"
#include "recordings/recording_formats.hpp"
#include "studies/field.hpp"

namespace hertzline::app {

namespace {

namespace fs = std::filesystem;

constexpr const char* plot_examples =
    "Waveform and spectrum of each column, in dB under the maximum, with the multiples of the drive's "
    "frequency and the band at -20 dB. The spectrum is that of the samples between --from and --to, at most "
    "the first million without a gap. Long recordings are drawn as smallest and largest sample of each "
    "pixel; live changes are marked. Several recordings lie over each other; one that does not say its "
    "drive has the drive of the others, if that is one. Of a sweep: curves over the key that varies, or a "
    "map over two, with the points that failed marked; with --columns its waveforms. Of a search: its "
    "measure over each key. Of a field: the pressure along a line, or the beam over a plane with lines at "
    "-6, -12 and -20 dB, over a box on three planes through its largest value; of one made with "
    "--waveforms also the spectrum at a point, the pressure over time along a line (waterfall), and over "
    "a plane as a movie, an animated GIF. Needs Python with matplotlib, for tables in .h5 files h5py, for "
    "movies Pillow.\n"
    "Examples:\n"
    "  hertzline plot burst.csv -o burst.png\n"
    "  hertzline plot live.h5 -o live.svg --columns v_out,f_last --from 0.5 --to 0.501\n"
    "  hertzline plot simulated.h5 measured.csv -o both.png --columns v_out\n"
    "  hertzline plot sweep.h5 -o sweep.png --quantity bandwidth_20db_hz\n"
    "  hertzline plot plane.h5 -o focus.png --kind spectrum --at x=0,10mm,z=40mm\n"
    "  hertzline plot line.h5 -o line.png --kind waterfall --from 100us --to 200us\n"
    "  hertzline plot plane.h5 -o plane.gif --kind movie --from 100us --to 150us --frames 100";

/// The views of a field. The last one moves.
constexpr std::array field_kinds{"beam", "spectrum", "waterfall", "movie"};
constexpr std::array moving_endings{".gif"};

struct PlotOptions {
    std::vector<std::string> recordings;
    std::string picture;
    std::vector<std::string> columns;     ///< columns of a recording; none: the first ones
    std::vector<std::string> quantities;  ///< quantities of a sweep; none: the usual ones
    std::string from;                     ///< time; empty: the beginning
    std::string to;                       ///< empty: the end
    std::optional<double> sample_rate_hz;
    std::string kind;           ///< view of a field; empty: its beam
    std::string at;             ///< points of a field, as --plane gives them
    std::optional<int> frames;  ///< of a movie
};

bool is_called(const recordings::Column& column, const std::string& name) {
    return column.name == name || column.quantity == name;
}

/// Returns the columns of those names, of all where none is named.
std::vector<std::size_t> columns_called(const recordings::RecordingHead& head,
                                        const std::vector<std::string>& names) {
    std::vector<std::size_t> chosen;
    for (std::size_t i = 0; i < head.columns.size(); ++i) {
        if (names.empty() || std::ranges::any_of(names, [&](const std::string& name) {
                return is_called(head.columns[i], name);
            })) {
            chosen.push_back(i);
        }
    }
    return chosen;
}

/// Returns the names that --columns takes.
std::vector<std::string> names_of_columns(const recordings::RecordingHead& head) {
    std::vector<std::string> names;
    for (const recordings::Column& column : head.columns) {
        if (std::ranges::find(names, column.quantity) == names.end()) {
            names.push_back(column.quantity);
        }
    }
    return names;
}

/// Returns the columns to be drawn. @throws WrongUse with every unknown name
std::vector<std::size_t> chosen_columns(const recordings::RecordingHead& head, const std::string& file,
                                        const PlotOptions& options) {
    const std::vector<std::string> names = names_of_columns(head);
    const bool one_of_many = options.recordings.size() > 1;  // another one may have the name
    std::vector<std::size_t> chosen = columns_called(head, options.columns);
    Faults faults;
    for (const std::string& name : options.columns) {
        if (columns_called(head, {name}).empty() && !(one_of_many && !chosen.empty())) {
            faults.add(one_of_many ? "--columns: " + printable(file) : "--columns",
                       fmt::format("found {}, allowed: {}{}", quoted_briefly(name), comma_separated(names),
                                   suggestion(name, names)));
        }
    }
    faults.refuse<WrongUse>();
    const std::size_t asked = chosen.size();
    if (one_of_many) {
        chosen.resize(std::min(chosen.size(), max_picture_panels));
    } else {
        chosen = columns_in_picture(head, chosen);
    }
    if (chosen.size() < asked) {
        spdlog::info("the picture shows {} of {} columns", chosen.size(), asked);
    }
    return chosen;
}

/// Returns the head of these columns alone.
recordings::RecordingHead head_of_columns(const recordings::RecordingHead& head,
                                          const std::vector<std::size_t>& chosen) {
    recordings::RecordingHead part = head;
    part.columns.clear();
    for (const std::size_t column : chosen) {
        part.columns.push_back(head.columns[column]);
    }
    return part;
}

/// Returns a time, with its unit or in seconds; nothing where the text is none.
std::optional<double> seconds_in(const std::string& text) {
    const auto plain = read_value(ValueKind::number, text);
    const auto seconds = plain ? std::optional(std::get<double>(*plain)) : number_in_unit(text, "s");
    return seconds && *seconds >= 0 ? seconds : std::nullopt;
}

Window window_of(const PlotOptions& options, Faults& faults) {
    Window window;
    for (const auto& [name, text, edge] : {std::tuple{"--from", &options.from, &window.from_s},
                                           std::tuple{"--to", &options.to, &window.to_s}}) {
        const auto seconds = text->empty() ? std::optional(*edge) : seconds_in(*text);
        if (!seconds) {
            faults.add(name, fmt::format("found {}, allowed: a time of at least 0 s, as 0.5 or \"500 us\"",
                                         quoted_briefly(*text)));
        }
        *edge = seconds.value_or(*edge);
    }
    if (window.from_s >= window.to_s) {
        faults.add("--to", fmt::format("found {}, allowed: more than --from", quoted_briefly(options.to)));
    }
    return window;
}

/// Reads the samples in the window. @throws std::runtime_error where there are none
Outline outline_of(recordings::RecordingReader& reader, const std::vector<std::size_t>& chosen,
                   double rate_hz, const Window& window, const std::string& file) {
    constexpr std::size_t portion = 1 << 14;  // rows
    constexpr double nearly = 1e-6;           // of a sample, as times are rounded
    constexpr double last_sample = 9e18;
    const auto limit = [&](double time_s, double nudge) {
        return static_cast<std::int64_t>(std::min(std::ceil(time_s * rate_hz + nudge), last_sample));
    };
    const std::int64_t first = limit(window.from_s, -nearly);
    const std::int64_t last = limit(window.to_s, nearly);
    const std::size_t columns = reader.head().columns.size();
    Outline outline(chosen, columns);
    std::int64_t end = 0;
    for (recordings::RecordedRows rows; end < last && reader.read(rows, portion);) {
        end = rows.first + static_cast<std::int64_t>(rows.values.size() / columns);
        const std::int64_t begin = std::clamp(first, rows.first, end);
        const std::int64_t count = std::clamp(last, begin, end) - begin;
        outline.take(begin, std::span(rows.values)
                                .subspan(static_cast<std::size_t>(begin - rows.first) * columns,
                                         static_cast<std::size_t>(count) * columns));
    }
    if (outline.empty()) {
        throw std::runtime_error(end == 0 ? printable(file) + " has no samples"
                                          : fmt::format("{} has no samples in this window: it ends at {} s",
                                                        printable(file),
                                                        number_text(static_cast<double>(end - 1) / rate_hz)));
    }
    return outline;
}

/// Whether the file is a CSV of a sweep; a recording's begins with its times.
bool is_csv_of_sweep(const std::string& file) {
    constexpr std::string_view first = "point,";
    std::string begin(first.size(), '\0');
    return recordings::recording_ending(file) == ".csv" &&
           std::ifstream(file, std::ios::binary)
               .read(begin.data(), static_cast<std::streamsize>(first.size())) &&
           begin == first;
}

Exit exit_of(Drawn drawn) {
    if (drawn == Drawn::stopped) {
        spdlog::error("stopped before the end; nothing was saved");
    }
    return drawn == Drawn::yes ? Exit::done : Exit::failed;
}

/// Draws a sweep or a field. @returns nothing when the file is none
std::optional<Exit> plot_sweep(const PlotOptions& options, const FieldView& view = {}) {
    const std::string& table = options.recordings.front();
    if (const std::string ending = recordings::recording_ending(table); ending != ".h5" && ending != ".csv") {
        return std::nullopt;
    }
    stop_asked();  // from here on there are files to be cleaned up
    const Drawn drawn =
        draw_sweep(options.picture, table, {options.quantities, options.columns, view}, printable(table));
    return drawn == Drawn::no_sweep ? std::nullopt : std::optional(exit_of(drawn));
}

constexpr const char* times_of_sweep =
    "--from, --to, --sample-rate: found a sweep, allowed: with recordings; --from and --to also with the "
    "waveforms of a field (--kind)";

bool has_times(const PlotOptions& options) {
    return !options.from.empty() || !options.to.empty() || options.sample_rate_hz;
}

/// Returns the file's name, with its folders where another file has the same name.
std::string name_in_legend(const std::string& file, const std::vector<std::string>& files) {
    const fs::path name = fs::path(file).filename();
    const bool once = std::ranges::count_if(files, [&](const std::string& other) {
                          return fs::path(other).filename() == name;
                      }) == 1;
    return printable(once ? name.string() : file);
}

/// Reads a recording. @throws WrongUse, std::runtime_error
RecordingOutline read_outline(recordings::RecordingReader& reader, const std::string& file,
                              const PlotOptions& options, const Window& window) {
    const std::vector<std::size_t> chosen = chosen_columns(reader.head(), file, options);
    recordings::RecordingHead head = head_of_columns(reader.head(), chosen);
    head.sample_rate_hz = options.sample_rate_hz.value_or(head.sample_rate_hz);
    if (!(head.sample_rate_hz > 0)) {
        throw WrongUse(printable(file) + " has no sample rate: give --sample-rate");
    }
    Outline outline = outline_of(reader, chosen, head.sample_rate_hz, window, file);
    return {name_in_legend(file, options.recordings), std::move(head), std::move(outline)};
}

/// Draws the sweep in a file that is no recording for this reason. @returns nothing when it is no sweep either
std::optional<Exit> plot_sweep_instead(const PlotOptions& options, const std::string& reason) {
    const std::string& file = options.recordings.front();
    if (options.recordings.size() > 1 || recordings::recording_ending(file) != ".h5" ||
        !fs::is_regular_file(file)) {
        return std::nullopt;
    }
    if (has_times(options)) {
        throw WrongUse(std::string(times_of_sweep) + ": " + reason);
    }
    return plot_sweep(options);
}

/// Draws the recordings, or the sweep if the file is no recording.
Exit plot_any(const PlotOptions& options, const Window& window) {
    std::vector<RecordingOutline> outlines;
    for (const std::string& file : options.recordings) {
        std::unique_ptr<recordings::RecordingReader> reader;
        try {
            reader = recordings::open_reader(
                file, {.sample_rate_hz = options.sample_rate_hz,
                       .warn = [](const std::string& warning) { spdlog::warn("{}", warning); }});
        } catch (const std::runtime_error& error) {
            if (const auto drawn = plot_sweep_instead(options, error.what())) {
                return *drawn;
            }
            if (options.recordings.size() > 1 && recordings::recording_ending(file) == ".h5") {
                throw std::runtime_error(std::string(error.what()) +
                                         "; a sweep, a search or a field is drawn by itself");
            }
            throw;
        }
        outlines.push_back(read_outline(*reader, file, options, window));
    }
    stop_asked();  // from here on there are files to be cleaned up
    return exit_of(draw_recordings(options.picture, outlines,
                                   outlines.size() == 1 ? printable(options.recordings.front()) : ""));
}

/// Returns the points of --at.
std::vector<studies::Point> points_at(const std::string& text, Faults& faults) {
    constexpr std::size_t most = 1000;
    Scene scene;
    scene.end.model = PlateModel::modal;  // has points
    std::vector<studies::Point> points;
    if (const auto grid = faults.value_of("--at", studies::parse_grid(scene, text))) {
        for (std::size_t i = 0; i < std::min(grid->size(), most); ++i) {
            points.push_back(grid->point(i));
        }
    }
    return points;
}

/// Returns the view of a field that is asked for.
FieldView view_of(const PlotOptions& options, const Window& window, Faults& faults) {
    const std::string& kind = options.kind;
    const std::string found = kind.empty() ? "found no --kind" : "found --kind " + printable(kind);
    if (!kind.empty() && std::ranges::find(field_kinds, kind) == field_kinds.end()) {
        faults.add("--kind",
                   fmt::format("found {}, allowed: {}", quoted_briefly(kind), fmt::join(field_kinds, ", ")));
    }
    if (!options.at.empty() && kind != "spectrum") {
        faults.add("--at", found + ", allowed: with --kind spectrum");
    }
    if (options.frames && kind != "movie") {
        faults.add("--frames", found + ", allowed: with --kind movie");
    }
    if (!kind.empty() && options.recordings.size() > 1) {
        faults.add("--kind: found several files, allowed: one field");
    }
    if (!kind.empty() && (!options.columns.empty() || options.sample_rate_hz)) {
        faults.add(fmt::format("{}: {}, allowed: without",
                               options.columns.empty() ? "--sample-rate" : "--columns", found));
    }
    if (!kind.empty() && kind != "beam" && !options.quantities.empty()) {
        faults.add("--quantity: " + found + ", allowed: with --kind beam");
    }
    return {kind, options.at.empty() ? std::vector<studies::Point>{} : points_at(options.at, faults), window,
            options.frames};
}

Exit plot(const PlotOptions& options) {
    Faults faults;
    for (const std::string& file : options.recordings) {
        faults.add(recordings::recording_fault(file, recordings::Access::reading));
        if (options.recordings.size() > 1 && is_csv_of_sweep(file)) {
            faults.add(printable(file),
                       "found a sweep among several files, allowed: recordings, or one sweep");
        }
    }
    faults.add("-o", options.kind == field_kinds.back() ? picture_fault(options.picture, moving_endings)
                                                        : picture_fault(options.picture));
    faults.add("--sample-rate", positive_fault(options.sample_rate_hz));
    const Window window = window_of(options, faults);
    const FieldView view = view_of(options, window, faults);
    if (!options.quantities.empty() && (!options.columns.empty() || options.recordings.size() > 1)) {
        faults.add(fmt::format("--quantity: found {}, too, allowed: with one sweep, by itself",
                               options.columns.empty() ? "several files" : "--columns"));
    }
    const bool is_sweep = options.recordings.size() == 1 && is_csv_of_sweep(options.recordings.front());
    const bool shows_numbers =
        view.kind == "beam" || (view.kind.empty() && (is_sweep || !options.quantities.empty()));
    if (has_times(options) && shows_numbers) {
        faults.add(std::string(times_of_sweep));
    }
    faults.refuse<WrongUse>();
    if (!view.kind.empty() || !options.quantities.empty() || is_sweep) {
        if (const auto drawn = plot_sweep(options, view)) {
            return *drawn;
        }
        const auto [thing, option, command] = view.kind.empty()
                                                  ? std::tuple("sweep", "--quantity", "hertzline sweep")
                                                  : std::tuple("field", "--kind", "hertzline field");
        throw WrongUse(fmt::format("{}: found no {}, allowed with {}: a table of {}",
                                   printable(options.recordings.front()), thing, option, command));
    }
    return plot_any(options, window);
}

}  // namespace

Run plot_command(CLI::App& app) {
    auto options = std::make_shared<PlotOptions>();
    app.add_option("RECORDING", options->recordings,
                   "recordings (" + recordings::recording_endings(recordings::Access::reading) +
                       "), or a sweep or field")
        ->required()
        ->check(missing_name)
        ->type_name("");
    app.add_option("-o,--output", options->picture, "the picture: .png, .svg or .pdf; of a movie .gif")
        ->required()
        ->type_name("FILE");
    add_repeatable_option(app, "--columns", options->columns,
                          "draw these outputs or columns only (default: the first six)")
        ->delimiter(',')
        ->type_name("OUTPUT,...");
    app.add_option("--from", options->from,
                   "draw from this time on, in s or with a unit; of a field with --kind")
        ->type_name("TIME");
    app.add_option("--to", options->to, "draw up to this time; of a field with --kind")->type_name("TIME");
    app.add_option("--sample-rate", options->sample_rate_hz, "sample rate of the files, whatever they say")
        ->type_name("HZ");
    add_repeatable_option(app, "--quantity", options->quantities, "of a sweep or field: draw these numbers")
        ->delimiter(',')
        ->type_name("QUANTITY,...");
    app.add_option("--kind", options->kind,
                   "of a field: beam (the default), or spectrum, waterfall or movie of its waveforms")
        ->type_name("beam|spectrum|waterfall|movie");
    app.add_option("--at", options->at,
                   "spectra at these points, as --plane of field takes them (default: the largest peak)")
        ->type_name("x=..,y=..,z=..");
    app.add_option("--frames", options->frames, "of a movie (default: eight for each period of the drive)")
        ->type_name("N");
    app.footer(plot_examples);
    return [options] { return plot(*options); };
}

}  // namespace hertzline::app
