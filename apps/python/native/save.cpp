#include "apps/python/native/save.hpp"

#include <algorithm>
#include <atomic>
#include <stdexcept>

#include "apps/python/native/interruptible.hpp"
#include "apps/python/native/python_values.hpp"
#include "core/scene/faults.hpp"
#include "hertzline/samples.hpp"
#include "measures/run.hpp"
#include "measures/tap_names.hpp"
#include "recordings/columns.hpp"
#include "recordings/recording_formats.hpp"
#include "recordings/recording_set.hpp"

namespace hertzline::python {

namespace {

constexpr std::size_t block_rows = 4096;

/// Fills the block with the next rows of the taps, as a simulation would.
void fill(Samples& block, const RunResult& result, TapSet taps, std::size_t first) {
    block.first = static_cast<std::int64_t>(first);
    block.count = std::min(block.capacity(), result.rows - first);
    block.holds = taps;
    for (const Tap tap : taps) {
        const std::size_t channels = channels_of(tap, result.counts);
        std::copy_n(result.column(tap).begin() + static_cast<std::ptrdiff_t>(first * channels),
                    block.count * channels, block.room(tap).begin());
    }
}

/// @throws std::runtime_error when one of the recordings has failed
void write(const RunResult& result, const std::vector<std::string>& paths,
           const recordings::RecordingHead& head, TapSet taps, const std::atomic<bool>& stop,
           std::vector<std::string>& warnings) {
    recordings::RecordingSet recordings(
        paths, head, recordings::RecordingPatience::endless(stop), [](const std::string&) {},
        recordings::Appearance::when_complete);
    recordings::RowBuilder rows(recordings, taps);
    Samples block(taps, result.counts, block_rows);
    for (std::size_t first = 0; first < result.rows && !stop; first += block.count) {
        fill(block, result, taps, first);
        rows.write(block);
    }
    if (stop) {
        recordings.discard();
        return;
    }
    recordings.commit();
    std::string failures;
    for (const recordings::RecordingSet::Status& status : recordings.status()) {
        if (!status.failure.empty()) {
            failures += (failures.empty() ? "" : "\n") + status.failure;
        }
    }
    if (!failures.empty()) {
        throw std::runtime_error(failures);
    }
    warnings = recordings.warnings();
}

}  // namespace

void save(const std::shared_ptr<RunResult>& result, const std::vector<std::string>& paths,
          const std::optional<std::vector<std::string>>& names, double wav_scale) {
    Faults faults;
    const TapSet taps = names ? measures::taps_named("taps", *names, result->held, faults) : result->asked;
    for (const std::string& fault : recordings::recordings_faults(paths)) {
        faults.add(fault);
    }
    faults.add("wav_scale", positive_fault(wav_scale));
    if (taps.empty() && (!names || names->empty())) {
        faults.add("taps: found none, allowed: at least one");
    }
    faults.refuse<py::value_error>();
    const recordings::RecordingHead head{.columns = recordings::recorded_columns(taps, result->counts),
                                         .sample_rate_hz = result->sample_rate_hz,
                                         .provenance = result->provenance,
                                         .full_scale = wav_scale};
    std::vector<std::string> warnings;
    with_os_errors([&] {
        interruptible_with_files(
            paths, [&](const std::atomic<bool>& stop) { write(*result, paths, head, taps, stop, warnings); });
    });
    warn_all(warnings);
}

}  // namespace hertzline::python
