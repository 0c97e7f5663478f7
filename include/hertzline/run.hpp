#pragma once
// A run: a scene from sample 0 to its end, its samples and its measures.

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <new>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "hertzline/resolve.hpp"
#include "hertzline/samples.hpp"
#include "hertzline/scene.hpp"
#include "hertzline/simulation.hpp"
#include "hertzline/spectrum.hpp"
#include "hertzline/taps.hpp"

namespace hertzline {

using Json = nlohmann::ordered_json;

/// Warnings, a sentence each.
using Warnings = std::vector<std::string>;

/// A tap's samples from the start to the end, one number each in the tap's unit, and their spectrum. Of an array: its middle element.
struct TapRecord {
    Tap tap;
    std::vector<double> values;
    SpectrumSummary spectrum;  ///< empty when the run was stopped
};

/// The energy that a modal plate took [J].
struct PlateEnergy {
    double passed = 0;    ///< to the plate
    double lost = 0;      ///< in its material
    double held = 0;      ///< in its motion at the end
    double radiated = 0;  ///< into the fluid
};

/// The energy of a horn on which the chain acts back [J].
struct HornEnergy {
    double source = 0;  ///< that its source gave
    double lost = 0;    ///< in the horn
    double held = 0;    ///< in its motion and spring at the end
};

/// A run and its results.
struct Run {
    Resolution resolved;              ///< of the first scene; its estimate becomes the worst of all scenes
    std::optional<Scene> last_scene;  ///< at the end, if the scene changed on the way

    std::vector<TapRecord> taps;         ///< v_out, then the other measured taps
    std::vector<double> v_out_smooth;    ///< with a plate: v_out as if the last contact never opened [m/s]
    double peak_v_last = 0;              ///< [m/s]
    double peak_p_points = 0;            ///< at the loudest of the scene's points [Pa]
    std::vector<double> peaks_p_points;  ///< at each of them [Pa]
    std::vector<double> p_first;         ///< samples at the first of them [Pa]
    std::optional<double>
        first_arrival_s;               ///< when the pressure at the first point exceeds half of its peak [s]
    std::optional<double> alone_p_pa;  ///< peak at the first point of the middle element of an array, alone
    std::int64_t steps = 0;
    double step_s = 0;  ///< step of the last simulation
    std::int64_t contact_events = 0;
    ContactLoad load;                      ///< the largest of each
    double static_pressure_pa = 0;         ///< the largest at rest [Pa]
    double deflection_m = 0;               ///< the largest of the plate's centre [m]; 0 without a plate
    std::optional<double> strength_ratio;  ///< the largest
    std::optional<std::string> strength_warning;  ///< warning of the scene with that ratio
    double energy_residual = 0;                   ///< residual of the ledger; the largest of several motions
    std::optional<PlateEnergy> plate;             ///< modal plates only
    std::optional<HornEnergy> horn;               ///< where the chain acts back on it
    double holder_lost = 0;                       ///< energy that the spheres' holder took [J]
    std::chrono::nanoseconds busy{0};             ///< simulating
    double setup_s = 0;                           ///< before the first step
    bool stopped = false;                         ///< by the user, before the end

    // of a run that was not stopped
    std::vector<double>
        switching_db;  ///< per harmonic of v_out: gain by the jumps of its formula; empty without a plate
    std::optional<double> ringing_ratio;  ///< ringing_ratio()
    std::optional<double>
        rung_down_s;    ///< a duration at whose end v_out no longer rings, where it rings at the run's end
    Warnings warnings;  ///< warnings of the result; summary_json() has those of the scene, too

    Json recordings;  ///< the written files; null: none

    const Scene& scene() const noexcept { return last_scene ? *last_scene : resolved.scene; }
    std::size_t rows() const { return taps.empty() ? 0 : taps.front().values.size(); }
    double simulated_s() const {
        return rows() > 0 ? static_cast<double>(rows() - 1) / scene().output.sample_rate_hz : 0;
    }
    double wall_s() const { return std::chrono::duration<double>(busy).count(); }

    /// The number of that name: "peak_v_out_m_per_s", "harmonics_db_3", "p_axis.thd_r" (docs/measures.md); NaN where the run does not
    /// determine it. @throws std::out_of_range for a name of no number, or of a tap that was not measured
    double operator[](std::string_view name) const;
};

/// The scene from a sample on.
struct SceneStep {
    std::int64_t sample =
        0;  ///< above that of the step before; of one that is not continued it may be the same
    bool continued =
        false;  ///< the motion continues (Simulation::continue_from); else it restarts from static equilibrium
    Scene scene;                                 ///< resolved; same samples
    std::optional<ErrorEstimate> estimate = {};  ///< of its error; unset: not known
};

/// Options of a run.
struct RunOptions {
    TapSet recorded = {};                           ///< taps for take, beside measured ones
    TapSet measured = {};                           ///< taps with a record and a spectrum, beside v_out
    std::optional<double> band_from_hz = {};        ///< as SpectrumAnalyser::analyse
    const std::atomic<bool>* stop = nullptr;        ///< true: the run ends before its end
    std::function<bool(const Samples&)> take = {};  ///< is given each block; false ends the run
    std::span<const SceneStep> steps = {};          ///< scenes that follow the first one
    std::shared_ptr<const PiecewiseMotion> live = nullptr;  ///< as in SimulationOptions
    std::size_t threads = 1;                                ///< as in SimulationOptions
    std::function<void(std::size_t step)> begins = {};      ///< is called before the samples of a step
};

/// A request for more memory than there is; the text has both amounts.
class OutOfMemory : public std::bad_alloc {
public:
    explicit OutOfMemory(std::string text) : text_(std::move(text)) {}
    const char* what() const noexcept override { return text_.c_str(); }

private:
    std::string text_;
};

/// Simulates and measures a scene. @throws std::invalid_argument with every fault of the scene, a line each, for a tap that it lacks, or for
/// more than 268435456 samples; OutOfMemory before it begins; std::runtime_error when the integration fails
Run run(const Resolution& resolved, const RunOptions& options = {});
/// Resolves the scene first.
Run run(const Scene& scene, const RunOptions& options = {});

/// The summary of a run as `hertzline run --json` prints it. docs/measures.md defines its members.
Json summary_json(const Run& run);

}  // namespace hertzline
