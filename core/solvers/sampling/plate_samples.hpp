#pragma once
// What a modal plate sends out when it moves by the steps of a grid: its parts of steps are handed to PlateOutputs as pieces, and the
// values of samples wait until the sampler asks for them.

#include <cstdint>
#include <vector>

#include "core/integrators/plate_motion.hpp"
#include "core/integrators/series_piece.hpp"
#include "core/plate/plate_steps.hpp"
#include "core/scene/scene.hpp"
#include "core/solvers/fixed_time.hpp"
#include "core/solvers/sampling/plate_outputs.hpp"

namespace hertzline {

class PlateSamples final : public PlateListener {
public:
    /// @param chain with a modal plate; outlives the object
    PlateSamples(const Chain& chain, const Scene& scene, double step_s, TapSet taps);

    /// Whether any of these taps is made here.
    static bool any_of(TapSet taps) noexcept;

    /// Back to sample 0, the plate at rest.
    void reset() noexcept;

    void note(const PlatePart& part) noexcept override;
    /// The plate has been at rest up to a step.
    void rest_until(std::int64_t step) noexcept;

    /// Steps that may be taken before samples are looked at again; a sample that lies further back is forgotten.
    std::int64_t steps_kept() const noexcept { return steps_kept_; }
    double v_face(std::int64_t sample) const noexcept { return v_face_[place(sample)]; }
    double p_axis(std::int64_t sample) const noexcept { return p_axis_[place(sample)]; }

private:
    std::size_t place(std::int64_t sample) const noexcept {
        return static_cast<std::size_t>(sample) % v_face_.size();
    }
    void describe(const PlatePart& part) noexcept;
    FixedTime in_samples(const StepMoment& moment) const noexcept;

    double step_s_;
    int grid_;              ///< steps per sample, as Sampler has it
    FixedTime per_sample_;  ///< steps
    FixedTime per_step_;    ///< samples; only off the grid
    double samples_per_step_;
    std::int64_t steps_kept_;
    kernels::PlateMotion motion_;
    kernels::SeriesPiece piece_;
    PlateOutputs outputs_;
    std::vector<double> v_face_, p_axis_;  // rings
    bool has_face_, has_pressure_;
    StepMoment reached_;
    std::int64_t next_ = 0;  ///< sample
    FixedTime next_at_;      ///< where it lies [steps]
};

}  // namespace hertzline
