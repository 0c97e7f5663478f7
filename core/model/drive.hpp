#pragma once
// Numbers of a drive, whatever its kind.

#include <optional>

#include "core/model/horn.hpp"
#include "hertzline/scene.hpp"

namespace hertzline {

/// How long a burst, or the record of a file, lasts [s].
double burst_duration_s(const Drive& drive);

/// When the first burst is over, in an array that of the last element [s]. @param scene has passed validate()
double first_burst_end_s(const Scene& scene);

/// The highest frequency of the tone, at its start or at the end of its sweep; of a record
/// that of its velocities on average [Hz].
double highest_frequency_hz(const Drive& drive);

/// Largest displacement [m] and velocity [m/s] of a free tip that a tone drives as a resonator, within the burst. Nothing of another
/// drive, of one at rest, and of bursts of more than 10 000 periods.
std::optional<HornMotion> tip_peak(const Drive& drive);

/// Largest velocity of the horn: 2 pi f A of a tone, or that of tip_peak() where it is larger [m/s]; 0 where there is none.
double largest_velocity(const Drive& drive);

/// A horn's tip as a resonator (docs/model.md, section 5): u'' + decay u' + square u = square r - (f_0 - F_0) inv_mass. A record is its free
/// motion x, with r = x + x' decay/square + x''/square; a tone drives it by r = gain x.
struct HornResonator {
    double square = 0;    ///< omega^2 [1/s^2]
    double decay = 0;     ///< omega/Q [1/s]
    double inv_mass = 0;  ///< 1/M_h [1/kg]; 0: the chain does not act back
    double gain = 1;
    bool record = false;
};

/// The quantity of its samples, which is a displacement where the scene does not say.
DriveQuantity recorded_quantity(const Drive& drive) noexcept;

/// Whether the horn moves as samples say, which the scene has: a record's, or those that a live drive had.
bool has_samples(const Drive& drive) noexcept;

/// Whether it is a live drive whose samples come while a stream runs: the scene has none, and names no file with them.
bool awaits_samples(const Drive& drive) noexcept;

/// The fault of a run with such a drive.
std::optional<Fault> awaited_samples_fault(const Drive& drive);

/// The tone that a live drive declares, for pilots: no other is known. A resonator is taken for rigid, as the chain takes little of its
/// motion. Any other scene as it is.
Scene as_declared(Scene scene);

/// The scene of a live drive with all that its keys leave open: the rate of the output, the quantity of the stream that it subscribes to,
/// and no repetition. Any other scene as it is.
Scene with_live_drive(Scene scene);

/// The scene of a live drive whose samples are still to come, with drive.start_s as long as it has to be at least, in whole samples of the
/// output: a sample is heard so much later, and a frame leaves when the samples have come that came before it. Any other scene as it is.
/// @param scene with integrator and step, and with_live_drive()
Scene with_latency(Scene scene);

/// How far a simulation looks beyond its next sample [s]. @param scene with integrator and step
double reach_beyond_sample_s(const Scene& scene) noexcept;

/// Nothing where the horn moves as prescribed.
std::optional<HornResonator> horn_resonator(const Drive& drive);

/// Why the drive of a valid scene cannot be computed: a record that was not read, or that does not begin at rest.
std::vector<Fault> drive_faults(const Drive& drive);

}  // namespace hertzline
