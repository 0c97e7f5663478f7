#include "apps/commands/run/run_files.hpp"

#include <algorithm>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "apps/commands/plot/picture.hpp"
#include "apps/console/signals.hpp"
#include "core/scene/text.hpp"
#include "hertzline/run.hpp"
#include "hertzline/spectrum.hpp"
#include "hertzline/taps.hpp"
#include "recordings/formats/table.hpp"
#include "recordings/recording_formats.hpp"

namespace hertzline::app {

namespace {

recordings::Table spectra_of(const hertzline::Run& run, const Json& provenance) {
    SpectrumAnalyser analyser(run.rows(), run.scene().output.sample_rate_hz);
    std::vector<recordings::Column> columns{{"frequency_hz", "frequency", "Hz"}};
    std::vector<std::vector<double>> values(1);
    for (const TapRecord& tap : run.taps) {
        const TapRow& row = row_of(tap.tap);
        MagnitudeSpectrum spectrum = analyser.magnitudes(tap.values);
        columns.push_back({std::string(row.column), std::string(row.name), std::string(row.unit)});
        values.front() = std::move(spectrum.frequencies_hz);
        values.push_back(std::move(spectrum.amplitudes));
    }
    return recordings::number_table(columns, std::move(values), provenance);
}

recordings::RecordingHead head_of(const hertzline::Run& run, const Json& provenance) {
    recordings::RecordingHead head;
    for (const TapRecord& tap : run.taps) {
        const TapRow& row = row_of(tap.tap);
        head.columns.push_back({std::string(row.column), std::string(row.name), std::string(row.unit)});
    }
    head.columns.resize(std::min(head.columns.size(), max_picture_panels));
    head.sample_rate_hz = run.scene().output.sample_rate_hz;
    head.provenance = provenance;
    return head;
}

/// @returns false when stopped meanwhile
bool draw(const std::string& file, const hertzline::Run& run, const recordings::RecordingHead& head,
          const std::string& title, std::optional<double> band_from_hz) {
    constexpr std::size_t portion = 1 << 14;  // rows
    const std::size_t columns = head.columns.size();
    std::vector<std::size_t> all(columns);
    std::iota(all.begin(), all.end(), std::size_t{0});
    RecordingOutline drawn{title, head, Outline(std::move(all), columns), band_from_hz};
    std::vector<double> rows;
    for (std::size_t first = 0; first < run.rows(); first += portion) {
        const std::size_t count = std::min(portion, run.rows() - first);
        rows.resize(count * columns);
        for (std::size_t i = 0; i < rows.size(); ++i) {
            rows[i] = run.taps[i % columns].values[first + i / columns];
        }
        drawn.outline.take(static_cast<std::int64_t>(first), rows);
    }
    return draw_recordings(file, std::span(&drawn, 1), title) == Drawn::yes;
}

}  // namespace

void check_spectra(std::span<const std::string> spectra, std::span<const std::string> recordings,
                   Faults& faults) {
    std::vector<std::string> before(recordings.begin(), recordings.end());
    for (const std::string& file : spectra) {
        const auto fault = recordings::table_fault(file);
        faults.add("--spectrum", fault ? fault : recordings::repeated_fault(file, before));
        before.push_back(file);
    }
}

bool save_spectra(std::span<const std::string> files, const hertzline::Run& run, const Json& provenance) {
    if (files.empty()) {
        return true;
    }
    const recordings::Table table = spectra_of(run, provenance);
    note_when_asked();  // from here on there are files to be cleaned up
    bool all = true;
    for (const std::string& file : files) {
        try {
            all = recordings::write_table(file, table, stop_asked()) && all;
        } catch (const std::runtime_error& error) {
            spdlog::error(error.what());
            all = false;
        }
    }
    end_at_once_when_asked();
    return all;
}

bool save_picture(const std::string& file, const hertzline::Run& run, const Json& provenance,
                  const std::string& title, std::optional<double> band_from_hz) {
    if (file.empty()) {
        return true;
    }
    note_when_asked();  // from here on there are files to be cleaned up
    bool drawn = false;
    try {
        drawn = draw(file, run, head_of(run, provenance), printable(title), band_from_hz);
    } catch (const std::runtime_error& error) {
        spdlog::error(error.what());
    }
    end_at_once_when_asked();
    return drawn;
}

}  // namespace hertzline::app
