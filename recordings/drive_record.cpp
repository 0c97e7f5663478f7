#include "recordings/drive_record.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <memory>
#include <numeric>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "core/model/drive.hpp"
#include "core/model/sampled_motion.hpp"
#include "core/scene/scene_key.hpp"
#include "core/scene/text.hpp"
#include "core/scene/units.hpp"
#include "hertzline/spectrum.hpp"
#include "recordings/recording_formats.hpp"

namespace hertzline::recordings {

namespace {

namespace fs = std::filesystem;

/// The number of the column, from 0 on, or its fault.
tl::expected<std::size_t, Fault> chosen_column(const std::vector<Column>& columns,
                                               const std::optional<std::string>& wanted) {
    const auto called = [&](std::string_view name) {
        std::vector<std::size_t> found;
        for (std::size_t i = 0; i < columns.size(); ++i) {
            const Column& column = columns[i];
            if (column.name == name || column.quantity == name ||
                fmt::format("{} ({})", column.name, column.unit) == name ||
                fmt::format("{} [{}]", column.name, column.unit) == name) {
                found.push_back(i);
            }
        }
        return found;
    };
    if (!wanted) {
        const auto horn = called("v_horn");  // of a recording of another run
        return horn.empty() ? 0 : horn.front();
    }
    const auto found = called(column_text(*wanted, wanted->size()));  // a name that was cut is no column's
    if (found.size() == 1) {
        return found.front();
    }
    if (!found.empty()) {
        std::vector<std::string> numbers;
        std::ranges::transform(found, std::back_inserter(numbers),
                               [](std::size_t i) { return std::to_string(i + 1); });
        return tl::unexpected(
            Fault{"drive.column",
                  fmt::format("{}, as {} columns are called", quoted_briefly(*wanted), found.size()),
                  "a number of a column: " + enumeration(numbers)});
    }
    if (const auto number = parsed_number<std::size_t>(*wanted);
        number && *number >= 1 && *number <= columns.size()) {
        return *number - 1;
    }
    std::vector<std::string> names;
    std::ranges::transform(columns, std::back_inserter(names), &Column::name);
    constexpr std::size_t most_listed = 16;
    const std::string more = names.size() > most_listed ? ", ..." : "";
    const std::string similar = suggestion(*wanted, names);
    names.resize(std::min(names.size(), most_listed));
    return tl::unexpected(Fault{"drive.column", quoted_briefly(*wanted),
                                fmt::format("one of {}{}, or a number from 1 to {}{}", comma_separated(names),
                                            more, columns.size(), similar)});
}

/// The column; where it has no unit, that of something else than a motion in which its name ends, as "ch1_mV", "a_m_per_s2".
Column with_other_unit(Column column) {
    constexpr std::array<std::string_view, 19> others{"v",   "mv",  "uv",  "kv",  "a", "ma", "n",
                                                      "mn",  "pa",  "kpa", "mpa", "g", "db", "inch",
                                                      "rad", "deg", "hz",  "s",   "s2"};
    constexpr std::string_view per = "_per_";  // of a motion it was found before
    const std::size_t slash = column.name.rfind(per);
    const std::size_t end = column.name.rfind('_', slash == 0 ? 0 : slash - 1);
    if (!column.unit.empty() || end == std::string::npos || end == 0) {
        return column;
    }
    std::string unit = column.name.substr(end + 1);
    if (slash != std::string::npos) {
        column.unit = unit.replace(slash - end - 1, per.size(), "/");
    } else if (std::ranges::find(others, lower_case(unit)) != others.end()) {
        column.unit = std::move(unit);
    }
    return column;
}

/// Sets quantity and scale as the column's unit tells, where the scene does not. @returns the fault of a unit that is neither
std::optional<Fault> take_unit(Drive& drive, const Column& column,
                               const std::function<void(const std::string&)>& warn) {
    const std::string one = "1 " + column.unit;
    const auto in = [&](std::string_view unit) {
        return column.unit == unit ? std::optional(1.0) : number_in_unit(one, unit);
    };
    const auto metres = in("m");
    const auto metres_per_s = in("m/s");
    if (!drive.quantity) {
        drive.quantity = metres_per_s ? DriveQuantity::velocity : DriveQuantity::displacement;
    }
    const bool velocity = drive.quantity == DriveQuantity::velocity;
    const auto unit = velocity ? metres_per_s : metres;
    if (!drive.scale && !unit && !column.unit.empty()) {
        return Fault{"drive.scale", fmt::format("nothing, with {} in {}", column.name, column.unit),
                     fmt::format("the {} that one {} stands for{}", velocity ? "m/s" : "m", column.unit,
                                 velocity ? "" : R"(; with drive.quantity = "velocity" the m/s)")};
    }
    const bool otherwise =
        metres || metres_per_s || in("m/s^2") || in("Pa");  // volts are what a scale is for
    if (drive.scale && !unit && otherwise) {
        warn(fmt::format("{} is in {}; drive.scale = {} takes it as {} all the same", column.name,
                         column.unit, number_text(*drive.scale), velocity ? "m/s" : "m"));
    }
    constexpr double noticed = 1e-9;
    if (drive.scale && unit && !column.unit.empty() && std::abs(*drive.scale / *unit - 1) > noticed) {
        warn(fmt::format("{} is in {}; drive.scale = {} takes the place of {}", column.name, column.unit,
                         number_text(*drive.scale), number_text(*unit)));
    }
    drive.scale = drive.scale.value_or(unit.value_or(1));
    return std::nullopt;
}

/// The frequency at which the horn is fastest [Hz]; nothing where the record is silent.
std::optional<double> strongest_line_hz(const Drive& drive) {
    const double rate = *drive.sample_rate_hz;
    std::vector<double> velocity = drive.samples;
    if (recorded_quantity(drive) == DriveQuantity::displacement) {
        std::adjacent_difference(velocity.begin(), velocity.end(), velocity.begin());
        velocity.front() = velocity.size() > 1 ? velocity[1] : 0;
    }
    const double drift =
        std::accumulate(velocity.begin(), velocity.end(), 0.0) / static_cast<double>(velocity.size());
    std::ranges::for_each(velocity, [drift](double& v) { v -= drift; });
    SpectrumAnalyser analyser(velocity.size(), rate);
    const MagnitudeSpectrum spectrum = analyser.magnitudes(velocity);
    const double bin_hz = spectrum.frequencies_hz[1];
    const auto kept =
        static_cast<std::size_t>(1.5 * lowpass_hz(drive) / bin_hz) + 1;  // bins that the low-pass leaves
    const std::span<const double> levels =
        std::span(spectrum.amplitudes)
            .first(std::min(std::max<std::size_t>(kept, 2), spectrum.amplitudes.size()));
    const auto peak = static_cast<std::size_t>(std::ranges::max_element(levels) - levels.begin());
    if (peak == 0 || levels[peak] == 0) {
        return std::nullopt;
    }
    double beside = 0;  // bins, by the parabola through the levels
    if (peak + 1 < levels.size()) {
        const double bend = levels[peak - 1] - 2 * levels[peak] + levels[peak + 1];
        beside = bend < 0 ? (levels[peak - 1] - levels[peak + 1]) / (2 * bend) : 0;
    }
    const Range allowed = scene_key_named(Scene{}, "drive.frequency_hz")->range;
    return std::clamp((static_cast<double>(peak) + beside) * bin_hz, allowed.min, allowed.max);
}

/// Reads the column's samples. @throws std::runtime_error, or the fault
std::optional<Fault> read_samples(RecordingReader& reader, std::size_t column, std::vector<double>& samples) {
    constexpr std::size_t portion = 65'536;
    const std::size_t columns = reader.head().columns.size();
    RecordedRows rows;
    std::optional<std::int64_t> due;
    while (reader.read(rows, portion)) {
        if (due && rows.first != *due) {
            return Fault{"drive.file",
                         fmt::format("a gap of {} samples after {}", rows.first - *due, samples.size()),
                         "a record without gaps"};
        }
        for (std::size_t at = column; at < rows.values.size(); at += columns) {
            samples.push_back(rows.values[at]);
        }
        if (samples.size() > max_drive_samples) {
            return Fault{"drive.file", fmt::format("more than {} samples", max_drive_samples),
                         fmt::format("at most {}: cut the record, or lower its rate", max_drive_samples)};
        }
        due = rows.first + static_cast<std::int64_t>(rows.values.size() / columns);
    }
    constexpr std::size_t fewest = 16;
    if (samples.size() < fewest) {
        return Fault{"drive.file", fmt::format("{} samples", samples.size()),
                     fmt::format("{} or more", fewest)};
    }
    return std::nullopt;
}

std::optional<Fault> read(ParsedScene& parsed, const fs::path& path,
                          const std::function<void(const std::string&)>& warn) {
    Drive drive = parsed.scene.drive;
    if (auto fault = recording_fault(path, Access::reading)) {
        return Fault{"drive.file", printable(*fault, 500), ""};
    }
    if (std::error_code unknown; !fs::is_regular_file(path, unknown)) {  // a pipe might never end
        return Fault{"drive.file", quoted_briefly(path.string()) + ", which is no file", "a recording"};
    }
    const auto reader = open_reader(path, {.sample_rate_hz = drive.sample_rate_hz, .warn = warn});
    const RecordingHead head = reader->head();
    const auto column = chosen_column(head.columns, drive.column);
    if (!column) {
        return column.error();
    }
    if (!drive.sample_rate_hz && head.sample_rate_hz > 0) {
        drive.sample_rate_hz = head.sample_rate_hz;
    }
    constexpr double noticed = 1e-6;
    if (drive.sample_rate_hz && head.sample_rate_hz > 0 &&
        std::abs(*drive.sample_rate_hz / head.sample_rate_hz - 1) > noticed) {
        warn(fmt::format("its rate is {} Hz; drive.sample_rate_hz = {} takes its place",
                         number_text(head.sample_rate_hz), number_text(*drive.sample_rate_hz)));
    }
    if (!drive.sample_rate_hz) {
        return Fault{"drive.sample_rate_hz", "nothing", "the record's rate, which its file does not tell"};
    }
    if (auto fault = read_samples(*reader, *column, drive.samples)) {
        return fault;
    }
    const Range allowed = scene_key_named(parsed.scene, "drive.samples")->range;
    for (const double sample : drive.samples) {
        if (!(sample >= allowed.min && sample <= allowed.max)) {
            return Fault{"drive.file", "the sample " + number_text(sample),
                         "samples from " + number_text(allowed.min) + " to " + number_text(allowed.max)};
        }
    }
    if (auto fault = take_unit(drive, with_other_unit(head.columns[*column]), warn)) {
        return fault;
    }
    drive.file.reset();
    drive.column.reset();
    parsed.scene.drive = std::move(drive);
    return std::nullopt;
}

/// Takes the strongest line as the frequency, unless that is given.
void take_line(ParsedScene& parsed) {
    Drive& drive = parsed.scene.drive;
    if (drive.sample_rate_hz && !gives_frequency(parsed)) {
        drive.frequency_hz = strongest_line_hz(drive).value_or(drive.frequency_hz);
    }
}

}  // namespace

bool gives_frequency(const ParsedScene& parsed) {
    const auto is_option = [&](const std::string& name) {
        const auto place = parsed.places.find(name);
        return place != parsed.places.end() ? std::optional(place->second.line == 0) : std::nullopt;
    };
    const auto frequency = is_option("drive.frequency_hz");
    const bool is_of_a_tone = frequency == false && is_option("drive.kind") == true;
    return frequency && !is_of_a_tone;
}

std::optional<fs::path> record_of(const ParsedScene& parsed) {
    if (!parsed.scene.drive.file) {
        return std::nullopt;
    }
    const fs::path file(*parsed.scene.drive.file);
    const auto place = parsed.places.find("drive.file");
    const bool option = place != parsed.places.end() && place->second.line == 0;
    return option ? file : fs::path(parsed.origin).parent_path() / file;
}

}  // namespace hertzline::recordings

namespace hertzline {

std::optional<Fault> read_drive(ParsedScene& parsed, const std::function<void(const std::string&)>& warn) {
    using namespace recordings;
    const Drive& drive = parsed.scene.drive;
    const bool record = drive.kind == DriveKind::file;
    if (!record && !(drive.kind == DriveKind::live && drive.file)) {
        return std::nullopt;
    }
    if (!drive.file) {
        if (!drive.samples.empty()) {
            take_line(parsed);
        }
        return std::nullopt;
    }
    if (!drive.samples.empty()) {
        return parsed.placed(
            Fault{"drive.file", quoted_briefly(*drive.file) + " beside drive.samples", "one of them"});
    }
    const auto warn_of_record = [&](const std::string& text) {
        if (warn) {
            warn(fmt::format("{}{}drive.file: {}", printable_whole(parsed.origin),
                             parsed.origin.empty() ? "" : ": ", text));
        }
    };
    try {
        auto fault = read(parsed, *record_of(parsed), warn_of_record);
        if (!fault && record) {
            take_line(parsed);
        }
        return fault ? std::optional(parsed.placed(*std::move(fault))) : std::nullopt;
    } catch (const std::runtime_error& error) {
        constexpr std::size_t longest = 500;
        return parsed.placed(Fault{"drive.file", printable(error.what(), longest), ""});
    }
}

}  // namespace hertzline
