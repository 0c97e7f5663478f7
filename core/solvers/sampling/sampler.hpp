#pragma once
// From moments of the integration to samples. The sample rate and the step are separate: samples that fall on
// steps are taken as they are, others from the cubic through values and slopes at both ends of the smooth
// piece that they lie in.

#include <cstdint>
#include <vector>

#include "core/integrators/kernels.hpp"
#include "core/model/chain.hpp"
#include "core/solvers/fixed_time.hpp"
#include "core/solvers/sampling/contact_forces.hpp"
#include "core/solvers/sampling/end_taps.hpp"
#include "hertzline/samples.hpp"

namespace hertzline {

/// Turns the rows that a kernel records into samples.
class Sampler {
public:
    /// @param chain outlives the sampler @param taps all that samples will be made of
    Sampler(const Chain& chain, const Scene& scene, double step_s, const SimulationOptions& options);

    /// Back to sample 0, the static equilibrium.
    void reset() noexcept;

    /// Back to sample 0, with the motion of that moment; for samples on the grid.
    void begin_with(const ChainState& state) noexcept;

    std::int64_t next_sample() const noexcept { return next_sample_; }

    /// The first step at whose end the samples before `end` are known.
    std::int64_t step_needed(std::int64_t end) const noexcept;

    /// Where the kernel puts its rows when samples are wanted. @param step steps taken so far
    kernels::Trace& wanted_from(std::int64_t step) noexcept;

    /// Puts down the samples before `end` that the trace encloses; without a sink they are only counted.
    void emit(Samples* samples, std::int64_t end) noexcept;

    /// Samples up to `end` are not wanted. @returns whether the kernel need not record anything for them.
    bool pass_over() noexcept;
    void passed_over(std::int64_t end) noexcept;

    kernels::Trace& trace() noexcept { return trace_; }

    /// Steps per sample when that is a whole number; 0: samples lie between steps.
    int grid() const noexcept { return grid_; }

    static double bytes(double bodies, TapSet taps) noexcept;

private:
    class Writer;

    void emit_rows(Writer* writer, std::int64_t end) noexcept;
    void emit_between(Writer* writer, std::int64_t end) noexcept;
    void drop_rows_before(std::size_t row) noexcept;

    const Chain& chain_;
    int grid_;                 ///< steps per sample when that is a whole number; 0: samples lie between steps
    FixedTime sample_period_;  ///< in steps
    double step_s_;
    EndTaps end_taps_;
    ContactForces contact_forces_;
    std::vector<double> rows_, fractions_;
    std::vector<std::int64_t> steps_;
    kernels::Trace trace_;
    std::int64_t next_sample_ = 0;
    FixedTime next_position_;  ///< of that sample, in steps
};

/// Whole steps per sample, or 0 when samples do not fall on steps.
int steps_per_sample(double step_s, double sample_rate_hz) noexcept;

/// The step that is used when `step_s` is asked for: one that divides the sample period but for rounding is taken
/// to divide it.
double exact_step(double step_s, double sample_rate_hz) noexcept;

}  // namespace hertzline
