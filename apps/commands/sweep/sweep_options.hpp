#pragma once
// The options of `hertzline sweep`, and the study that follows from them.

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "apps/arguments/scene_argument.hpp"
#include "apps/console/output.hpp"
#include "core/scene/faults.hpp"
#include "studies/study.hpp"

namespace hertzline::app {

struct SweepOptions {
    SceneRequest scene;
    std::vector<std::string> vary;
    std::string points;  ///< a file; empty: none
    std::optional<std::int64_t> sobol;
    std::vector<std::string> files;       ///< tables; none: rows go to stdout. The first names the journal
    std::vector<std::string> measures;    ///< taps that are measured beside v_out
    std::vector<std::string> quantities;  ///< numbers that are kept; none: all
    std::optional<double> band_from_hz;
    std::string waveform;     ///< a tap; empty: none
    std::optional<int> jobs;  ///< unset: jobs_of() decides
    bool resume = false;
    std::string shard;               ///< as in shard_argument(); empty: all points
    std::vector<std::string> parts;  ///< journals to be merged; none: a sweep is run
    Format format = Format::text;
};

/// Adds the options that searches have, too: measurements, instruction set, threads, files. @param options outlive the parsing
void add_point_options(CLI::App& app, SweepOptions& options);
/// Adds all options of a sweep. @param options outlive the parsing
void add_sweep_options(CLI::App& app, SweepOptions& options);

/// A sweep that can run.
struct ValidatedSweep {
    studies::Study study;
    studies::PlanSummary summary;
};

/// Checks the options and the scene of every point. Returns the sweep, or adds the faults.
std::optional<ValidatedSweep> validated_sweep(const SweepOptions& options, Faults& others);

/// Returns the number of threads.
int jobs_of(const SweepOptions& options);

/// Adds the fault of a sweep with neither a file nor --json.
void check_output(const SweepOptions& options, Faults& faults);

/// Adds the fault of each file that cannot be a sweep's table, or is named twice. @param waveform only HDF5 holds them
void check_tables(std::span<const std::string> files, std::optional<Tap> waveform, Faults& faults);

}  // namespace hertzline::app
