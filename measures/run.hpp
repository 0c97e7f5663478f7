#pragma once
// The parts of a run, for callers that go through it block by block. measures/quantities.hpp has its numbers.

#include <cstddef>
#include <functional>
#include <optional>
#include <string>

#include "core/model/chain.hpp"
#include "core/model/end.hpp"
#include "hertzline/run.hpp"

namespace hertzline::measures {

/// The longest record that a spectrum is made of [rows].
inline constexpr double max_run_rows = 268'435'456;

/// Taps that have a peak and a spectrum of their own.
inline constexpr TapSet measurable_taps = taps_where(
    [](const TapRow& row) { return row.channels == Channels::one || row.channels == Channels::per_element; });

/// Taps that are measured beside v_out without being asked for, when the scene has them.
inline constexpr TapSet measured_unasked = TapSet(Tap::p_axis) | Tap::v_centre;

/// The taps that a run of this scene measures beside v_out.
TapSet measured_taps(const Scene& scene, TapSet asked) noexcept;

/// Rows at k / sample_rate_hz up to and including duration_s. The product is taken for the whole number that
/// it misses by rounding only: 500e-6 s at 10e6 Hz are 5001 rows.
double rows_of_run(const Scene& scene) noexcept;

/// The taps that a run simulates: recorded and measured ones, and those that its numbers need.
TapSet taps_of_run(const Scene& scene, TapSet wanted) noexcept;

/// Whether the motion continues when one resolved scene becomes the other: drives and steps may differ, the horn's material may
/// not. Else it restarts from static equilibrium.
bool motion_goes_on(const Scene& from, const Scene& to);

/// Samples that are simulated, then written, at a time.
std::size_t block_of_run(const Scene& scene, TapSet taps) noexcept;

/// Bytes of the simulation, a block, the records of v_out and the measured taps, and their spectra; roughly from above. In double, so
/// that any request can be judged.
double memory_of_run(const Scene& scene, TapSet taps, TapSet measured);

/// Returns the fault of a run whose record is too long for its spectrum.
std::optional<std::string> longest_run_fault(const Scene& scene);

/// Returns the fault of a lower edge of bands that is no frequency.
std::optional<std::string> band_from_fault(std::optional<double> from_hz);

/// Simulates a scene: all of run() but measure() (measures/measuring.hpp). @throws as run()
Run simulate(const Resolution& resolved, const RunOptions& options);

/// Adds the loads of a chain's contacts to the largest ones, and judges them. @param scene of the chain, an element of an array
/// @param peaks largest overlaps [m]
void add_contacts(Run& run, const Scene& scene, const Chain& chain, const Eigen::ArrayXd& peaks);

/// A run of a simulation without samples yet, with room for all of them.
Run empty_run(Resolution resolved, TapSet measured, const EndModel& end);

/// Fills an empty run from a simulation, block by block. @param take as RunOptions::take
/// @returns running: all rows are there; stopped: the simulation's stop flag or take() ended it; else the failure, which
/// Simulation::failure() explains
Status fill(Run& run, Simulation& simulation, const std::function<bool(const Samples&)>& take);

}  // namespace hertzline::measures
