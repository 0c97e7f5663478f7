#include "apps/commands/preflight.hpp"

#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>

#include "core/scene/faults.hpp"
#include "core/scene/text.hpp"
#include "hertzline/spectrum.hpp"
#include "measures/resources.hpp"
#include "recordings/formats/table.hpp"
#include "recordings/recording_formats.hpp"
#include "recordings/recording_set.hpp"

namespace hertzline::app {

namespace {

constexpr double lines_per_row = 2.1;  // in a spectrum, which is padded to four times its record

double numbers_of(const Scene& scene, TapSet taps) noexcept {
    return channels_of(taps, channel_counts(scene));
}

}  // namespace

double memory_of_recorded_run(const Scene& scene, TapSet recorded, TapSet measured) {
    const double queue_bytes = std::min(
        rows_of_run(scene) * sizeof(double) * numbers_of(scene, recorded),
        recordings::RecordingSet::queue_bytes(numbers_of(scene, recorded), scene.output.sample_rate_hz));
    return measures::memory_of_run(scene, taps_of_run(scene, recorded | measured), measured) + queue_bytes;
}

double memory_of_recordings(const Scene& scene, TapSet recorded, std::size_t files) noexcept {
    return static_cast<double>(files) *
           recordings::RecordingSet::queue_bytes(numbers_of(scene, recorded), scene.output.sample_rate_hz);
}

double file_bytes(const Scene& scene, double samples, const std::string& file, TapSet taps) {
    return recordings::recording_bytes(file, numbers_of(scene, taps), samples);
}

void refuse_disk_shortages(const Scene& scene, double samples, std::span<const std::string> files,
                           TapSet taps) {
    for (const std::string& file : files) {
        const double bytes = file_bytes(scene, samples, file, taps);
        throw_if(measures::disk_shortage(file, bytes));
    }
}

void refuse_shortages(const Scene& scene, const RunOutputs& outputs) {
    const double rows = rows_of_run(scene);
    const double lines = lines_per_row * rows;
    const double columns = 1 + static_cast<double>((outputs.measured | Tap::v_out).size());
    const double spectra_bytes = outputs.spectra.empty() ? 0 : (columns + 2) * lines * sizeof(double);
    const std::string run =
        fmt::format("a run of {} rows (duration_s times sample_rate_hz)", number_text(rows));
    throw_if(measures::memory_shortage(
        run, memory_of_recorded_run(scene, outputs.recorded, outputs.measured) + spectra_bytes));
    throw_if(measures::longest_run_fault(scene));
    refuse_disk_shortages(scene, rows, outputs.files, outputs.recorded);
    const std::vector<recordings::TableColumn> numbers(static_cast<std::size_t>(columns));
    for (const std::string& file : outputs.spectra) {
        throw_if(measures::disk_shortage(file, recordings::table_bytes(file, numbers, lines)));
    }
}

}  // namespace hertzline::app
