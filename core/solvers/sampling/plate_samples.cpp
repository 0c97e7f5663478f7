#include "core/solvers/sampling/plate_samples.hpp"

#include <algorithm>
#include <cmath>

#include "core/integrators/kernels.hpp"
#include "core/solvers/sampling/sampler.hpp"

namespace hertzline {

namespace {

constexpr double samples_kept = 4096;  // roughly, beyond those of a few steps

kernels::HornWaves no_horn(double step_s) {
    return {{0, 0, 0}, step_s};
}

}  // namespace

bool PlateSamples::any_of(TapSet taps) noexcept {
    return !(taps & (TapSet(Tap::v_face) | Tap::v_out | Tap::p_axis)).empty();
}

PlateSamples::PlateSamples(const Chain& chain, const Scene& scene, double step_s, TapSet taps)
    : step_s_(step_s),
      grid_(steps_per_sample(step_s, scene.output.sample_rate_hz)),
      per_sample_(sample_period(step_s, scene.output.sample_rate_hz)),
      per_step_(FixedTime::of(scene.output.sample_rate_hz * step_s)),
      samples_per_step_(grid_ > 0 ? 1.0 / grid_ : scene.output.sample_rate_hz * step_s),
      steps_kept_(std::max<std::int64_t>(1, static_cast<std::int64_t>(samples_kept / samples_per_step_))),
      motion_(*chain.end.plate, kernels::kernel_lanes(), PlatePart::terms, step_s),
      piece_(1, PlatePart::terms, no_horn(step_s), DampingLaw::dashpot),
      outputs_(chain, &motion_, piece_, Integrator::taylor8, 1 / scene.output.sample_rate_hz, taps),
      has_face_(taps.contains(Tap::v_face) || taps.contains(Tap::v_out)),
      has_pressure_(taps.contains(Tap::p_axis)) {
    piece_.plate = &motion_;
    const double kept = std::ceil((static_cast<double>(steps_kept_) + 2) * samples_per_step_) + 2;
    v_face_.resize(static_cast<std::size_t>(kept));
    p_axis_.resize(v_face_.size());
    reset();
}

void PlateSamples::reset() noexcept {
    outputs_.reset();
    motion_.rest();
    std::fill(v_face_.begin(), v_face_.end(), 0.0);
    std::fill(p_axis_.begin(), p_axis_.end(), 0.0);
    reached_ = {};
    next_ = 0;
    next_at_ = {};
}

FixedTime PlateSamples::in_samples(const StepMoment& moment) const noexcept {
    if (grid_ > 0) {
        const std::int64_t steps = moment.step % grid_;
        FixedTime at = FixedTime::of((static_cast<double>(steps) + moment.fraction) / grid_);
        at.whole += moment.step / grid_;
        return at;
    }
    FixedTime at = per_step_.times(moment.step);
    at.advance(FixedTime::of(moment.fraction * samples_per_step_));
    return at;
}

void PlateSamples::rest_until(std::int64_t step) noexcept {
    const double steps = static_cast<double>(step - reached_.step) - reached_.fraction;
    note({.from = reached_, .to = {step, 0}, .duration_s = steps * step_s_});
}

/// The modes' velocities become those of the piece.
void PlateSamples::describe(const PlatePart& part) noexcept {
    piece_.unit_s = part.duration_s;
    piece_.per_unit = 1 / part.duration_s;
    motion_.centre = motion_.face = {};
    motion_.moves = false;
    for (std::size_t power = 0; power < part.velocities.size(); ++power) {
        for (std::size_t n = 0; n < motion_.modes(); ++n) {
            const double term = part.velocities[power][n];
            motion_.mode_terms()[power * motion_.stride() + n] = term;
            motion_.centre.terms[power] += term;
            motion_.face.terms[power] += motion_.mean_shapes()[n] * term;
            motion_.moves = motion_.moves || term != 0;
        }
    }
}

void PlateSamples::note(const PlatePart& part) noexcept {
    reached_ = part.to;
    const auto after = [&part](std::int64_t step, double fraction) {
        return static_cast<double>(step - part.from.step) + fraction;
    };
    const double begin = part.from.fraction;
    const double end = after(part.to.step, part.to.fraction);
    if (!(end > begin)) {
        return;
    }
    describe(part);
    const Stretch stretch{in_samples(part.from), in_samples(part.to)};
    // the sampler compares the same numbers: what it puts down has been here
    const auto next_at = [&] { return after(next_at_.whole, next_at_.fraction()); };
    while (next_at() <= end) {
        const double at = next_at();
        const std::size_t i = place(next_);
        EndMotion motion{.first = next_};
        motion.v_face = has_face_ ? &v_face_[i] : nullptr;
        motion.p_axis = has_pressure_ ? &p_axis_[i] : nullptr;
        outputs_.put(motion, {(at - begin) / (end - begin), 0, 1}, 1, stretch, next_);
        ++next_;
        next_at_.advance(per_sample_);
    }
    outputs_.leave_piece(stretch);
}

}  // namespace hertzline
