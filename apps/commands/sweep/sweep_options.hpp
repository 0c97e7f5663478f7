#pragma once
// The options of `hertzline sweep`, and the sweep that they ask for.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "studies/sweep/survey.hpp"
#include "studies/sweep/sweep.hpp"
#include <CLI/CLI.hpp>

#include "apps/arguments/scene_argument.hpp"
#include "apps/console/output.hpp"
#include "core/scene/faults.hpp"

namespace hertzline::app {

struct SweepOptions {
    SceneRequest scene;
    std::vector<std::string> vary;
    std::string points;  ///< a file; empty: none
    std::optional<std::int64_t> sobol;
    std::vector<std::string> files;     ///< tables; none: rows go to stdout. The first one names the journal
    std::vector<std::string> measures;  ///< taps to be measured beside v_out
    std::vector<std::string> quantities;  ///< what is kept; none: all
    std::optional<double> band_from_hz;
    std::string waveform;     ///< a tap; empty: none
    std::optional<int> jobs;  ///< unset: jobs_of() decides
    bool resume = false;
    std::string shard;               ///< as shard_argument() reads it; empty: all
    std::vector<std::string> parts;  ///< journals to be merged; none: a sweep is run
    Format format = Format::text;
};

/// What is measured of points, by which instructions, on how many threads, and where it goes. @param options must outlive the parsing
void add_point_options(CLI::App& app, SweepOptions& options);
/// All of a sweep. @param options must outlive the parsing
void add_sweep_options(CLI::App& app, SweepOptions& options);

/// A sweep without faults.
struct SoundSweep {
    studies::Sweep sweep;
    studies::SweepSurvey survey;
};

/// Makes the sweep of the options, and looks at the scene of every point. Or adds the faults.
std::optional<SoundSweep> sound_sweep(const SweepOptions& options, Faults& others);

/// Returns the number of threads.
int jobs_of(const SweepOptions& options);

}  // namespace hertzline::app
