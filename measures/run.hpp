#pragma once
// A run: a scene from sample 0 to its end, its samples and measures. measures/quantities.hpp has its numbers.

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "measures/spectrum.hpp"
#include <tl/expected.hpp>

#include "core/model/end.hpp"
#include "core/model/validity.hpp"
#include "core/samples.hpp"
#include "core/scene/json.hpp"
#include "core/scene/scene.hpp"
#include "core/simulation.hpp"
#include "core/step_choice/resolve.hpp"
#include "core/taps.hpp"

namespace hertzline::measures {

/// The longest record that a spectrum is made of [rows].
inline constexpr double max_run_rows = 268'435'456;

/// Taps that have a peak and a spectrum of their own.
inline constexpr TapSet measurable_taps =
    taps_where([](const TapRow& row) { return row.channels == Channels::one; });

/// Taps that are measured beside v_out without being asked for, when the scene has them.
inline constexpr TapSet measured_unasked = TapSet(Tap::p_axis) | Tap::v_centre;

/// The taps that a run of this scene measures beside v_out.
TapSet measured_taps(const Scene& scene, TapSet asked) noexcept;

/// Rows at k / sample_rate_hz up to and including duration_s. The product is taken for the whole number that
/// it misses by rounding only: 500e-6 s at 10e6 Hz are 5001 rows.
double rows_of_run(const Scene& scene) noexcept;

/// The taps that a run simulates: recorded and measured ones, and those that its numbers need.
TapSet taps_of_run(const Scene& scene, TapSet wanted) noexcept;

/// Samples that are simulated, then written, at a time.
std::size_t block_of_run(const Scene& scene, TapSet taps) noexcept;

/// Bytes of the simulation, a block, the records of v_out and the measured taps, and their spectra; roughly from above. In double, so
/// that any request can be judged.
double memory_of_run(const Scene& scene, TapSet taps, TapSet measured) noexcept;

/// Returns the fault of a run whose record is too long for its spectrum.
std::optional<std::string> longest_run_fault(const Scene& scene);

/// Returns the fault of a lower edge of bands that is no frequency.
std::optional<std::string> band_from_fault(std::optional<double> from_hz);

/// Warnings, a sentence each.
using Warnings = std::vector<std::string>;

/// A tap's samples from the start to the end, and their spectrum.
struct TapRecord {
    Tap tap;
    std::vector<double> values;
    SpectrumSummary spectrum;  ///< by measure()
};

/// The energy that a modal plate took [J].
struct PlateEnergy {
    double passed = 0;    ///< to the plate
    double lost = 0;      ///< in its material
    double held = 0;      ///< in its motion at the end
    double radiated = 0;  ///< into the fluid
};

/// A run and its results.
struct Run {
    Resolution resolved;
    std::optional<Scene> last_scene;  ///< at the end, if the scene changed on the way

    // by simulate()
    std::vector<TapRecord> taps;       ///< v_out, then the other measured taps
    std::vector<double> v_out_smooth;  ///< with a plate: v_out as if the last contact never opened
    double peak_v_last = 0;            ///< [m/s]
    std::int64_t steps = 0;
    double step_s = 0;  ///< step of the last simulation
    std::int64_t contact_events = 0;
    ContactLoad load;                             ///< the largest of each
    double static_pressure_pa = 0;                ///< the largest at rest [Pa]
    std::optional<double> strength_ratio;         ///< the largest
    std::optional<std::string> strength_warning;  ///< warning of the scene with that ratio
    double energy_residual = 0;                   ///< residual of the ledger; the largest of several
    std::optional<PlateEnergy> plate;             ///< modal plates only
    std::chrono::nanoseconds busy{0};             ///< simulating
    double setup_s = 0;                           ///< before the first step
    bool stopped = false;                         ///< by the user, before the end

    // by measure()
    std::vector<double>
        switching_db;  ///< per harmonic of v_out: gain by the jumps of its formula; empty without a plate
    std::optional<double> ringing_ratio;  ///< ringing_ratio()
    Warnings warnings;                    ///< warnings of the result; scene_warnings() has those of the scene

    Json recordings;  ///< the written files; null: none

    const Scene& scene() const noexcept { return last_scene ? *last_scene : resolved.scene; }
    std::size_t rows() const { return taps.front().values.size(); }
    double simulated_s() const { return static_cast<double>(rows() - 1) / scene().output.sample_rate_hz; }
    double wall_s() const { return std::chrono::duration<double>(busy).count(); }

    /// The number of that name: "peak_v_out_m_per_s", "harmonics_db_3", "p_axis.thd_r" (docs/measures.md); NaN where the run does not
    /// determine it. @throws std::out_of_range for a name of no number
    double operator[](std::string_view name) const;
};

/// The scene from a sample on.
struct SceneStep {
    std::int64_t sample = 0;  ///< above that of the step before
    bool continued =
        false;  ///< the motion continues (Simulation::continue_from); else it restarts from static equilibrium
    Scene scene;  ///< resolved; same samples
};

/// Options of a run.
struct RunOptions {
    TapSet recorded = {};                               ///< taps for take, beside measured ones
    TapSet measured = {};                               ///< beside v_out: measured_taps()
    std::optional<double> band_from_hz = {};            ///< as SpectrumAnalyser::analyse
    const std::atomic<bool>* stop = nullptr;            ///< true: the run ends before its end
    std::function<bool(const Samples&)> take = {};      ///< is given each block; false ends the run
    std::span<const SceneStep> steps = {};              ///< scenes that follow the first one
    std::function<void(std::size_t step)> begins = {};  ///< is called before the samples of a step
};

/// Simulates and measures a scene. @throws std::runtime_error when the integration fails; std::bad_alloc
Run run(const Resolution& resolved, const RunOptions& options = {});

/// Simulates a scene: all of run() but measure(). @throws as run()
Run simulate(const Resolution& resolved, const RunOptions& options);

/// Adds spectra and warnings to a run that has all its samples.
/// @param analyser for records of that length and rate @param band_from_hz as SpectrumAnalyser::analyse
void measure(Run& run, SpectrumAnalyser& analyser, std::optional<double> band_from_hz);

/// A run of a simulation without samples yet, with room for all of them.
Run empty_run(Resolution resolved, TapSet measured, const EndModel& end);

/// Fills an empty run from a simulation, block by block. @param take as RunOptions::take
/// @returns running: all rows are there; stopped: the simulation's stop flag or take() ended it; else the failure, which
/// Simulation::failure() explains
Status fill(Run& run, Simulation& simulation, const std::function<bool(const Samples&)>& take);

/// Warnings of a scene before it runs: its validity, and an accuracy that is not kept.
Warnings scene_warnings(const Resolution& resolved);

/// Returns a warning of a scene that misses its accuracy, with the reason, or may miss it, with the unknown part.
/// Nothing when it is met.
std::optional<std::string> missed_accuracy(const Resolution& resolved);

/// The names of the taps, in the order of the set.
std::vector<std::string> names_of(TapSet taps);

/// Returns the tap of that name, or a fault.
tl::expected<Tap, std::string> find_tap(std::string_view name, TapSet allowed);

/// The measurable taps among the names; other names are passed over.
TapSet measurable_among(std::span<const std::string> names) noexcept;

}  // namespace hertzline::measures
