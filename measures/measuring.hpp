#pragma once
// The numbers and warnings of a run that has all its samples, and the warnings of a scene before it runs.

#include <atomic>
#include <optional>
#include <string>

#include "hertzline/run.hpp"

namespace hertzline {
struct Chain;
}

namespace hertzline::measures {

/// Adds spectra and warnings to a run that has all its samples.
/// @param analyser for records of that length and rate; null: no spectra, and no warnings of them
/// @param band_from_hz as SpectrumAnalyser::analyse
void measure(Run& run, SpectrumAnalyser* analyser, std::optional<double> band_from_hz,
             const std::atomic<bool>* stop);

/// Warnings of a scene before it runs: keys without effect, its validity, and an accuracy that is not kept.
Warnings scene_warnings(const Resolution& resolved);
/// The same. @param chain of the scene, or of an array's first element
Warnings scene_warnings(const Resolution& resolved, const Chain& chain);

/// Warnings of a run's scene, then those of its result.
Warnings all_warnings(const Run& run);

/// "the estimated error over the first 0.001 s is 0.0002, above the requested accuracy of 0.0001"
std::string missed_by(const Resolution& resolved, const ErrorEstimate& estimate);

/// Returns a warning of a scene that misses its accuracy, with the reason, or may miss it, with the unknown part.
/// Nothing when it is met.
std::optional<std::string> missed_accuracy(const Resolution& resolved);

}  // namespace hertzline::measures
