#pragma once
// Rows, memory and disk of a run. Counted in double: an absurd request overflows nothing.

#include <filesystem>
#include <span>
#include <string>

#include "measures/run.hpp"

#include "core/scene/scene.hpp"
#include "core/simulation.hpp"

namespace hertzline::app {

using measures::rows_of_run;
using measures::taps_of_run;

/// Memory of the simulation, its blocks, the queues of its files, the records of v_out and of the other measured
/// taps, and their spectra.
double memory_of_recorded_run(const Scene& scene, TapSet recorded, TapSet measured) noexcept;

/// Queues of a stream's files that hold those taps; each file may be stuck with other rows. (The recordings of a run
/// share one queue.)
double memory_of_recordings(const Scene& scene, TapSet recorded, std::size_t files) noexcept;

/// Bytes of a recording of the taps in the format of that file, at most.
double file_bytes(const Scene& scene, double samples, const std::string& file, TapSet taps);

/// @throws std::runtime_error when there is not enough disk for one of the files with so many samples.
void refuse_disk_shortages(const Scene& scene, double samples, std::span<const std::string> files,
                           TapSet taps);

/// The rows and files of a run.
struct RunDemand {
    std::span<const std::string> files;  ///< recordings
    TapSet recorded;
    std::span<const std::string> spectra;  ///< files
    TapSet measured;
};

/// @throws std::runtime_error when there is not enough memory, or not enough disk for one of the files.
void refuse_shortages(const Scene& scene, const RunDemand& demand);

/// @throws WrongUse that names every file whose ending is no recording's, or that is named twice
void refuse_wrong_files(std::span<const std::string> files);

}  // namespace hertzline::app
