#pragma once
// A run from sample 0 to its end: how long it is, what is simulated, and what is kept of it for its summary, its spectra and its picture.

#include <chrono>
#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "measures/run_account.hpp"
#include <tl/expected.hpp>

#include "core/model/end.hpp"
#include "core/samples.hpp"
#include "core/scene/scene.hpp"
#include "core/simulation.hpp"
#include "core/taps.hpp"

namespace hertzline::measures {

/// The longest record that a spectrum is made of [rows].
inline constexpr double max_run_rows = 268'435'456;

/// What has a peak and a spectrum of its own.
inline constexpr TapSet measurable_taps =
    taps_where([](const TapRow& row) { return row.channels == Channels::one; });

/// What is measured beside v_out when the scene has it.
inline constexpr TapSet measured_unasked = TapSet(Tap::p_axis) | Tap::v_centre;

/// Rows at k / sample_rate_hz up to and including duration_s. The product is taken for the whole number that
/// it misses by rounding only: 500e-6 s at 10e6 Hz are 5001 rows.
double rows_of_run(const Scene& scene) noexcept;

/// What a run simulates: the taps that it records or measures, and those that its summary is made of.
TapSet taps_of_run(const Scene& scene, TapSet wanted) noexcept;

/// Samples that are simulated, then written, at a time.
std::size_t block_of_run(const Scene& scene, TapSet taps) noexcept;

/// A tap's samples from the start to the end.
struct TapRecord {
    Tap tap;
    std::vector<double> values;
};

struct RunRecord {
    std::vector<TapRecord> taps;       ///< v_out, then the others that are measured
    std::vector<double> v_out_smooth;  ///< with a plate: v_out as if the last contact never opened
    double peak_v_last = 0;            ///< [m/s]
    RunAccount account;                ///< once all rows are there
    std::chrono::nanoseconds busy{0};  ///< simulating
    bool stopped = false;              ///< by the user, before the end

    std::size_t rows() const { return taps.front().values.size(); }
    double wall_s() const { return std::chrono::duration<double>(busy).count(); }
};

/// With room for so many rows.
RunRecord empty_record(TapSet measured, const EndModel& end, std::size_t rows);

/// Takes the next samples.
void keep(const Samples& block, const EndModel& end, RunRecord& record);

/// Another scene from a sample on.
struct SceneStep {
    std::int64_t sample = 0;  ///< above that of the step before
    bool goes_on = false;     ///< the motion goes on (Simulation::continue_from); else it begins anew
    Scene scene;              ///< resolved; same samples
};

/// The scenes that follow the first one.
struct SceneSteps {
    std::vector<SceneStep> steps;
    SimulationOptions options;                          ///< of their simulations
    std::function<void(std::size_t step)> begins = {};  ///< called before the samples of a step
    std::unique_ptr<Simulation> last = nullptr;  ///< after the run: that of the last step, if one has begun
};

/// Simulates to the end of the run, block by block, and keeps what the record keeps.
/// @param record empty_record() @param take is called with each block once it has been kept; false ends the run
/// @returns running: all rows are there; stopped: the simulation's stop flag or take() said so; else what went wrong: failure()
/// says it
/// @param steps null: the scene stays the same
Status simulate(Simulation& simulation, RunRecord& record, const std::function<bool(const Samples&)>& take,
                SceneSteps* steps = nullptr);

/// The names of the taps, in the order of the set.
std::vector<std::string> names_of(TapSet taps);

/// The tap of that name, or what was found and what is allowed.
tl::expected<Tap, std::string> find_tap(std::string_view name, TapSet allowed);

/// Those of one channel among the names; names that are no such tap are passed over.
TapSet measurable_among(std::span<const std::string> names) noexcept;

}  // namespace hertzline::measures
