#pragma once
// From moments of the integration to samples. The sample rate and the step are separate: samples that fall on
// steps are taken as they are, others from the cubic through values and slopes at both ends of the smooth
// piece that they lie in.

#include <cstdint>
#include <vector>

#include "core/integrators/trace.hpp"
#include "core/samples.hpp"

namespace hertzline {

class Sampler {
public:
    /// @param most the largest wish that samples will be made for
    Sampler(const Chain& chain, double sample_rate_hz, double step_s, Wish most);

    /// Back to sample 0, the static equilibrium.
    void reset(const Chain& chain) noexcept;

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

    static double bytes(double bodies, Wish most) noexcept;

private:
    void emit_rows(Samples* samples, std::int64_t end) noexcept;
    void emit_between(Samples* samples, std::int64_t end) noexcept;
    void drop_rows_before(std::size_t row) noexcept;

    int grid_;  ///< steps per sample when that is a whole number; 0: samples lie between steps
    StepPosition sample_period_;  ///< in steps
    double step_s_;
    bool plate_;
    double transmission_;
    double end_overlap_;  ///< static, of the last contact [m]
    std::vector<double> rows_, fractions_;
    std::vector<std::int64_t> steps_;
    kernels::Trace trace_;
    std::int64_t next_sample_ = 0;
    StepPosition next_position_;  ///< of that sample
};

/// The step that is used for a wish of `step_s`: one that divides the sample period but for rounding is taken
/// to divide it.
double exact_step(double step_s, double sample_rate_hz) noexcept;

}  // namespace hertzline
