// hertzline plot: a picture of a recording, or of a sweep.

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "apps/arguments/options.hpp"
#include "apps/command.hpp"
#include "apps/commands/plot/picture.hpp"
#include "apps/console/signals.hpp"
#include "core/scene/text.hpp"
#include "recordings/recording_formats.hpp"

namespace hertzline::app {

namespace {

namespace fs = std::filesystem;

constexpr const char* examples =
    "Waveform and spectrum of each column, in dB under the maximum, with the multiples of the drive's "
    "frequency and the band at -20 dB. Of a sweep: curves over the key that varies, or a map over two, with "
    "the points that failed marked. Of a search: its measure over each key. Needs Python with "
    "matplotlib.\n"
    "Examples:\n"
    "  hertzline plot burst.csv -o burst.png\n"
    "  hertzline plot live.h5 -o live.svg --columns v_out,f_last\n"
    "  hertzline plot sweep.h5 -o sweep.png --quantity bandwidth_20db_hz";

struct PlotOptions {
    std::string recording;
    std::string picture;
    std::vector<std::string> columns;     ///< columns of a recording; none: the first ones
    std::vector<std::string> quantities;  ///< quantities of a sweep; none: the usual ones
};

bool is_called(const recordings::Column& column, const std::string& name) {
    return column.name == name || column.quantity == name;
}

/// Returns the columns to be drawn. @throws WrongUse with every unknown name
std::vector<std::size_t> chosen_columns(const recordings::RecordingHead& head, const PlotOptions& options) {
    std::vector<std::size_t> chosen;
    std::vector<std::string> names;
    for (std::size_t i = 0; i < head.columns.size(); ++i) {
        const recordings::Column& column = head.columns[i];
        if (options.columns.empty() || std::ranges::any_of(options.columns, [&](const std::string& name) {
                return is_called(column, name);
            })) {
            chosen.push_back(i);
        }
        if (names.empty() || names.back() != column.quantity) {
            names.push_back(column.quantity);
        }
    }
    Faults faults;
    for (const std::string& name : options.columns) {
        const auto has_name = [&](const recordings::Column& column) { return is_called(column, name); };
        if (std::ranges::none_of(head.columns, has_name)) {
            faults.add("--columns", fmt::format("found {}, allowed: {}{}", quoted_briefly(name),
                                                comma_separated(names), suggestion(name, names)));
        }
    }
    faults.refuse<WrongUse>();
    if (chosen.size() > max_picture_columns) {
        spdlog::info("the picture shows the first {} of {} columns", max_picture_columns, chosen.size());
        chosen.resize(max_picture_columns);
    }
    return chosen;
}

recordings::RecordingHead head_of_columns(const recordings::RecordingHead& head,
                                          const std::vector<std::size_t>& chosen) {
    recordings::RecordingHead part = head;
    part.columns.clear();
    for (const std::size_t column : chosen) {
        part.columns.push_back(head.columns[column]);
    }
    part.numbers = recordings::NumberType::float64;
    return part;
}

/// Returns the chosen columns, as many as a picture takes. Warns of further ones.
std::vector<recordings::RecordedRows> samples_of(recordings::RecordingReader& reader,
                                                 const std::vector<std::size_t>& chosen) {
    constexpr std::size_t portion = 1 << 14;  // rows
    const std::size_t columns = reader.head().columns.size();
    std::vector<recordings::RecordedRows> samples;
    recordings::RecordedRows rows;
    std::int64_t taken = 0;
    while (reader.read(rows, portion)) {
        if (taken >= max_picture_samples) {
            spdlog::info("the picture shows the first {} samples", taken);
            break;
        }
        samples.push_back({rows.first, {}});
        for (std::size_t row = 0; row < rows.values.size(); row += columns) {
            for (const std::size_t column : chosen) {
                samples.back().values.push_back(rows.values[row + column]);
            }
        }
        taken += static_cast<std::int64_t>(rows.values.size() / columns);
    }
    return samples;
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

/// Draws a sweep. @returns nothing when the file is none
std::optional<Exit> plot_sweep(const PlotOptions& options) {
    stop_asked();  // from here on there are files to be cleaned up
    switch (
        draw_sweep(options.picture, options.recording, options.quantities, printable(options.recording))) {
        case Drawn::yes:
            return Exit::done;
        case Drawn::stopped:
            spdlog::error("stopped before the end; nothing was saved");
            return Exit::failed;
        case Drawn::no_sweep:
            break;
    }
    return std::nullopt;
}

Exit plot_recording(const PlotOptions& options, recordings::RecordingReader& reader) {
    if (!(reader.head().sample_rate_hz > 0)) {
        throw std::runtime_error(options.recording + "  has no sample rate");
    }
    const std::vector<std::size_t> chosen = chosen_columns(reader.head(), options);
    const std::vector<recordings::RecordedRows> samples = samples_of(reader, chosen);
    if (samples.empty()) {
        throw std::runtime_error(options.recording + " has no samples");
    }
    stop_asked();  // from here on there are files to be cleaned up
    Picture picture(options.picture, head_of_columns(reader.head(), chosen));
    for (const recordings::RecordedRows& rows : samples) {
        picture.write(rows.first, rows.values);
    }
    if (!picture.draw(printable(options.recording))) {
        spdlog::error("stopped before the end; nothing was saved");
        return Exit::failed;
    }
    return Exit::done;
}

/// Draws the recording, or the sweep if the file is no recording.
Exit plot_either(const PlotOptions& options) {
    std::unique_ptr<recordings::RecordingReader> reader;
    try {
        reader = recordings::open_reader(options.recording);
    } catch (const std::runtime_error&) {
        if (recordings::recording_ending(options.recording) == ".h5" &&
            fs::is_regular_file(options.recording)) {
            if (const auto drawn = plot_sweep(options)) {
                return *drawn;
            }
        }
        throw;
    }
    return plot_recording(options, *reader);
}

Exit plot(const PlotOptions& options) {
    Faults faults;
    faults.add(recordings::recording_fault(options.recording));
    faults.add("-o", picture_fault(options.picture));
    if (!options.columns.empty() && !options.quantities.empty()) {
        faults.add("--quantity: found --columns, too, allowed: the one of a sweep, the other of a recording");
    }
    faults.refuse<WrongUse>();
    if (!options.quantities.empty() || is_csv_of_sweep(options.recording)) {
        if (const auto drawn = plot_sweep(options)) {
            return *drawn;
        }
        throw WrongUse(fmt::format("{}: found no sweep, allowed with --quantity: a table of hertzline sweep",
                                   printable(options.recording)));
    }
    return plot_either(options);
}

}  // namespace

Run plot_command(CLI::App& app) {
    auto options = std::make_shared<PlotOptions>();
    app.add_option("RECORDING", options->recording,
                   "a recording (" + recordings::recording_endings() + "), or a sweep")
        ->required()
        ->check(missing_name)
        ->type_name("");
    app.add_option("-o,--output", options->picture, "the picture: .png, .svg or .pdf")
        ->required()
        ->type_name("FILE");
    add_repeatable_option(app, "--columns", options->columns,
                          "draw these outputs or columns only (default: the first six)")
        ->delimiter(',')
        ->type_name("NAME,...");
    add_repeatable_option(app, "--quantity", options->quantities, "of a sweep: draw these numbers")
        ->delimiter(',')
        ->type_name("NAME,...");
    app.footer(examples);
    return [options] { return plot(*options); };
}

}  // namespace hertzline::app
