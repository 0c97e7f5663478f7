#pragma once
// One point of a sweep, from its scene to its row. What can be kept from point to point is kept here.

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "measures/run.hpp"
#include "measures/spectrum.hpp"
#include "studies/sweep/point_result.hpp"

#include "core/scene/scene.hpp"
#include "core/step_choice/finer_run.hpp"

namespace hertzline::studies {

/// What a sweep measures of each point.
struct PointDemand {
    TapSet measured;                     ///< beside v_out, where the scene has them
    std::optional<double> band_from_hz;  ///< as of SpectrumAnalyser::analyse
    std::vector<NumberColumn> columns;   ///< what is kept
    std::optional<Tap> waveform;         ///< is kept, too
    std::size_t waveform_samples = 0;    ///< of the longest point
};

/// What is wrong with a scene before it is run, of itself: what validate() finds, or a record too long for its spectrum. Empty: nothing.
std::string scene_refusal(const Scene& scene);

/// Bytes that a point takes while it is run, roughly from above; without its waveform.
double point_memory_bytes(const Scene& scene, const PointDemand& demand) noexcept;

/// Runs points one after another. For one thread. The row depends on the point's number, the scene and the demand alone.
class PointRunner {
public:
    /// @param stop ends a point within a few steps; both outlive this
    PointRunner(const PointDemand& demand, const std::atomic<bool>& stop);

    /// Never throws because of what a scene does. @returns the row, or nothing when it was stopped
    std::optional<PointResult> run(std::int64_t point, const Scene& scene) noexcept;

private:
    PointResult row(std::int64_t point) const;
    /// A simulation of a point with some step.
    struct Attempt {
        measures::Run run;
        Simulation simulation;
        std::optional<FinerRun> finer;  ///< unless pilots have chosen the step
    };

    bool try_run(const Scene& scene, PointResult& result);
    std::optional<Attempt> attempt_with_pilots(const Scene& scene, PointResult& result);
    std::optional<Attempt> attempt_unmeasured(const Scene& scene, PointResult& result);
    void check(std::int64_t point, Resolution& resolved) const;
    Attempt make_attempt(Resolution resolved) const;
    bool simulate(Attempt& attempt, PointResult& result);
    void measure(Attempt& attempt, PointResult& result);
    measures::SpectrumAnalyser& analyser(std::size_t rows, double sample_rate_hz);

    const PointDemand& demand_;
    const std::atomic<bool>& stop_;
    std::unique_ptr<measures::SpectrumAnalyser> analyser_;  // of the last point
    std::size_t analysed_rows_ = 0;
    double analysed_rate_hz_ = 0;
};

}  // namespace hertzline::studies
