#pragma once
// Rows, memory and disk of a run, in double: no request overflows them.

#include <filesystem>
#include <span>
#include <string>

#include "hertzline/scene.hpp"
#include "hertzline/simulation.hpp"
#include "measures/run.hpp"

namespace hertzline::app {

using measures::rows_of_run;
using measures::taps_of_run;

/// Returns the bytes of the simulation, its blocks, the queues of its files, the records of v_out and of the other measured
/// taps, and their spectra.
double memory_of_recorded_run(const Scene& scene, TapSet recorded, TapSet measured);

/// Returns the bytes of the queues of a stream's files that hold those taps: one a file, since each may be stuck with
/// other rows. (The recordings of a run share one queue.)
double memory_of_recordings(const Scene& scene, TapSet recorded, std::size_t files) noexcept;

/// Returns the most bytes of a recording of the taps in the format of that file.
double file_bytes(const Scene& scene, double samples, const std::string& file, TapSet taps);

/// @throws std::runtime_error when there is not enough disk for one of the files with so many samples.
void refuse_disk_shortages(const Scene& scene, double samples, std::span<const std::string> files,
                           TapSet taps);

/// The rows and files of a run.
struct RunOutputs {
    std::span<const std::string> files;  ///< recordings
    TapSet recorded;
    std::span<const std::string> spectra;  ///< files
    TapSet measured;
};

/// @throws std::runtime_error when there is not enough memory, or not enough disk for one of the files.
void refuse_shortages(const Scene& scene, const RunOutputs& demand);

}  // namespace hertzline::app
