#pragma once
// One point of a study: its scene, its simulation, and the row that is kept of it.

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/step_choice/finer_run.hpp"
#include "hertzline/resolve.hpp"
#include "hertzline/scene.hpp"
#include "hertzline/spectrum.hpp"
#include "measures/quantities.hpp"
#include "measures/run.hpp"

namespace hertzline::studies {

using measures::no_number;
using measures::NumberColumn;

/// The outcome of a point; word_of() names it in files.
enum class PointStatus : std::uint32_t {
    ok,  ///< all numbers are there
    inaccurate,  ///< all numbers are there; the estimated error exceeds the accuracy, is unknown, or covers part of the run
    chaotic,  ///< all numbers are there; the motion amplifies rounding errors, so that no step is good enough
    refused,  ///< the scene cannot be simulated: no numbers
    unstable,  ///< the integration failed: no numbers
    failed,    ///< the machine lacked memory or another resource: no numbers; --resume tries again
};
inline constexpr std::array<std::string_view, 6> point_status_words{"ok",      "inaccurate", "chaotic",
                                                                    "refused", "unstable",   "failed"};
constexpr std::string_view word_of(PointStatus status) noexcept {
    return point_status_words[static_cast<std::size_t>(status)];
}
/// Returns the status of the word, or nothing for an unknown word.
constexpr std::optional<PointStatus> status_named(std::string_view word) noexcept {
    for (std::size_t i = 0; i < point_status_words.size(); ++i) {
        if (point_status_words[i] == word) {
            return static_cast<PointStatus>(i);
        }
    }
    return std::nullopt;
}

/// Of a column of statuses.
inline constexpr std::size_t status_bytes = 12;

/// The status of a scene's run that did not fail.
PointStatus status_of(const Resolution& resolved) noexcept;

/// The measurements of a study, the same at every point.
struct PointOptions {
    TapSet measured;                     ///< beside v_out, where the scene has them
    std::optional<double> band_from_hz;  ///< as in SpectrumAnalyser::analyse
    std::vector<NumberColumn> columns;   ///< numbers that are kept
    std::optional<Tap> waveform;         ///< samples that are kept
    std::size_t waveform_samples = 0;    ///< at the longest point
    std::size_t waveform_channels = 1;   ///< at the point with most of them
    bool frequency_given = false;        ///< records that vary leave drive.frequency_hz as it is

    /// How many numbers the waveform of a point has.
    std::size_t waveform_size() const noexcept { return waveform ? waveform_samples * waveform_channels : 0; }
};

/// A row of a study, without the values of the plan.
struct PointResult {
    std::int64_t point = 0;
    PointStatus status = PointStatus::ok;
    std::string integrator;       ///< word; empty: none was chosen
    std::string scene_hash;       ///< hash of the resolved scene; empty: it could not be resolved
    std::string message;          ///< warnings, or the reason why there are no numbers
    std::vector<double> numbers;  ///< no_number where the run does not determine it
    std::vector<float> waveform;  ///< row-major [sample][channel]; NaN after the last sample and channel
};

/// Returns the faults that a scene has by itself, before it runs: those of validate(), or a record too long for its spectrum.
/// Empty: it can run.
std::string scene_refusal(const Scene& scene);

/// Returns the memory that a point takes while it runs, roughly from above, without its waveform [bytes].
double point_memory_bytes(const Scene& scene, const PointOptions& options);

/// Runs points one after another, in one thread. A row depends only on the point's number, its scene and the options.
class PointRunner {
public:
    /// @param stop ends a point within a few steps; both outlive this
    PointRunner(const PointOptions& options, const std::atomic<bool>& stop);

    /// Runs a point. Faults of its scene are in the row. @returns the row, or nothing when it was stopped
    std::optional<PointResult> run(std::int64_t point, const Scene& scene);

private:
    PointResult row(std::int64_t point) const;
    /// A simulation with a step that may turn out too long.
    struct Candidate {
        Run run;
        Simulation simulation;
        std::optional<FinerRun> finer;  ///< unless pilots have chosen the step
    };

    bool try_run(const Scene& scene, PointResult& result);
    std::optional<Candidate> run_with_pilots(const Scene& scene, PointResult& result);
    std::optional<Candidate> run_without_pilots(const Scene& scene, PointResult& result);
    void check(std::int64_t point, Resolution& resolved) const;
    Candidate make_candidate(Resolution resolved) const;
    bool simulate(Candidate& candidate, PointResult& result);
    void measure(Candidate& candidate, PointResult& result);
    SpectrumAnalyser* analyser(std::size_t rows, double sample_rate_hz);

    const PointOptions& options_;
    const std::atomic<bool>& stop_;
    std::unique_ptr<SpectrumAnalyser> analyser_;  // of the last point
    std::size_t analysed_rows_ = 0;
    double analysed_rate_hz_ = 0;
};

}  // namespace hertzline::studies
