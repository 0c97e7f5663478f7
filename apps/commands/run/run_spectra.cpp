#include "apps/commands/run/run_spectra.hpp"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <set>
#include <stdexcept>
#include <utility>

#include "measures/run.hpp"
#include "measures/spectrum.hpp"
#include "recordings/formats/table.hpp"
#include "recordings/recording_formats.hpp"
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "apps/arguments/options.hpp"
#include "apps/command.hpp"
#include "apps/console/signals.hpp"
#include "core/taps.hpp"

namespace hertzline::app {

namespace {

recordings::Table spectra_of(const measures::Run& run, const Json& provenance) {
    measures::SpectrumAnalyser analyser(run.rows(), run.scene().output.sample_rate_hz);
    std::vector<recordings::Column> columns{{"frequency_hz", "frequency", "Hz"}};
    std::vector<std::vector<double>> values(1);
    for (const measures::TapRecord& tap : run.taps) {
        const TapRow& row = row_of(tap.tap);
        measures::MagnitudeSpectrum spectrum = analyser.magnitudes(tap.values);
        columns.push_back({std::string(row.column), std::string(row.name), std::string(row.unit)});
        values.front() = std::move(spectrum.frequencies_hz);
        values.push_back(std::move(spectrum.amplitudes));
    }
    return recordings::number_table(columns, std::move(values), provenance);
}

}  // namespace

void refuse_wrong_spectra(std::span<const std::string> spectra, std::span<const std::string> recordings) {
    std::set<std::filesystem::path> names;
    for (const std::string& file : recordings) {
        names.insert(recordings::recording_name(file));
    }
    Faults faults;
    for (const std::string& file : spectra) {
        faults.of([&] {
            if (const auto fault = recordings::table_fault(file)) {
                throw WrongUse("--spectrum: " + *fault);
            }
            if (!names.insert(recordings::recording_name(file)).second) {
                throw WrongUse(
                    fmt::format("--spectrum: {}: found a second time, allowed: each file once", file));
            }
        });
    }
    faults.refuse();
}

bool save_spectra(std::span<const std::string> files, const measures::Run& run, const Json& provenance) {
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

}  // namespace hertzline::app
