#include "core/step_choice/pilot.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace hertzline {

namespace {

/// Stretches are chosen so that they take fewer; pieces of a series may be far shorter than foreseen.
constexpr double far_too_many_body_steps = 8 * affordable_body_steps;

/// Beside the spheres' velocities. The pressure of a plane wave with the velocity v is rho c v: over rho c it is one of them.
std::vector<PilotOutput> outputs_of(const EndModel& end) {
    if (end.plate) {
        const Fluid& fluid = end.plate->parameters.fluid;
        return {{Tap::v_centre, 1},
                {Tap::v_face, 1},
                {Tap::p_axis, 1 / (fluid.density_kg_per_m3 * fluid.sound_speed_m_per_s)}};
    }
    return end.has_plate ? std::vector<PilotOutput>{{Tap::v_plate, 1}, {Tap::v_out, 1}}
                         : std::vector<PilotOutput>{};
}

SimulationOptions options_of_pilots(const Scene& scene, const std::atomic<bool>* stop) {
    const double bodies = static_cast<double>(scene.chain.spheres) + 1;
    const bool lumped = provides(scene.end, Requires::lumped_plate);
    return {.taps = TapSet(Tap::v_chain) | (lumped ? TapSet(Tap::v_plate) | Tap::v_out
                                                   : TapSet(Tap::v_centre) | Tap::v_face | Tap::p_axis),
            .ledger = LedgerKeeping::off,
            .stop = stop,
            .max_steps = static_cast<std::int64_t>(far_too_many_body_steps / bodies)};
}

}  // namespace

Scene with_step(Scene scene, Integrator integrator, double step_s) {
    scene.numerics.integrator = integrator;
    scene.numerics.step_s = step_s;
    return scene;
}

Scene without_sleep(Scene scene) {
    scene.numerics.rest_tolerance = 0;
    return scene;
}

Pilot::Pilot(const Scene& scene, Integrator integrator, double step_s, const std::atomic<bool>* stop)
    : simulation_(with_step(scene, integrator, step_s), options_of_pilots(scene, stop)),
      outputs_(outputs_of(simulation_.chain().end)),
      block_(simulation_.make_samples(pilot_block)),
      spheres_(block_.spheres()),
      columns_(spheres_ + outputs_.size()),
      event_rate_(scene.drive) {}

void Pilot::run_to(std::size_t samples, double most_body_steps) {
    const double most_steps = most_body_steps / static_cast<double>(spheres_ + 1);
    const std::size_t block = std::isfinite(most_steps) ? counted_block : pilot_block;
    while (stable_ && this->samples() < samples && static_cast<double>(steps()) < most_steps) {
        const std::size_t wanted = std::min(block, samples - this->samples());
        stable_ = simulation_.advance(block_, wanted) == Status::running;
        const std::size_t before = velocities_.size();
        velocities_.resize(before + block_.count * columns_);
        auto out = velocities_.begin() + static_cast<std::ptrdiff_t>(before);
        for (std::size_t i = 0; i < block_.count; ++i) {
            out = std::ranges::copy(block_[Tap::v_chain].subspan(i * spheres_, spheres_), out).out;
            for (const PilotOutput& output : outputs_) {
                *out++ = output.scale * block_[output.tap][i];
            }
        }
        event_rate_.note(static_cast<double>(simulation_.next_sample()) / sample_rate_hz(),
                         simulation_.contact_events());
    }
}

Difference difference(const Pilot& pilot, const Pilot& better, std::size_t samples, std::size_t of) {
    if (pilot.samples() < samples || better.samples() < of) {
        constexpr double infinite = std::numeric_limits<double>::infinity();
        return {infinite, infinite, 0};
    }
    const std::size_t columns = better.columns();
    std::vector<double> wrong(columns);
    std::vector<double> norm(columns);
    for (std::size_t i = 0; i < samples; ++i) {
        const double* const a = pilot.row(i);
        const double* const b = better.row(i);
        for (std::size_t c = 0; c < columns; ++c) {
            const double d = a[c] - b[c];
            wrong[c] += d * d;
            norm[c] += b[c] * b[c];
        }
    }
    for (std::size_t i = samples; i < of; ++i) {
        const double* const b = better.row(i);
        for (std::size_t c = 0; c < columns; ++c) {
            norm[c] += b[c] * b[c];
        }
    }
    const double floor = quiet_column * quiet_column * *std::max_element(norm.begin(), norm.end());
    Difference result;
    for (std::size_t c = 0; c < columns; ++c) {
        const double scale = std::max(norm[c], floor);
        const double error = scale > 0 ? std::sqrt(wrong[c] / scale) : 0;
        result.of_any = std::max(result.of_any, error);
        result.of_output = c + 1 < better.spheres() ? 0 : std::max(result.of_output, error);
    }
    result.loudness = better.has_plate() ? std::sqrt(std::max(norm.back(), floor)) : 0;
    return result;
}

WrongSides wrong_sides(const Pilot& pilot, const Pilot& better, std::size_t samples, double jump) noexcept {
    WrongSides wrong;
    if (!better.has_plate()) {
        return wrong;
    }
    const std::size_t last = better.spheres() - 1;
    const std::size_t plate = better.spheres();
    const std::size_t out = plate + 1;
    double shift = 0;    // of the last sphere against the plate, between the pilots [samples * m/s]
    double through = 0;  // velocity through the last contact in the sample before [m/s]
    double jumps = 0;    // expected sum of their errors [m/s]
    double squares = 0;  // and of the squares [m^2/s^2]
    for (std::size_t i = 0; i < samples; ++i) {
        const double* const a = pilot.row(i);
        const double* const b = better.row(i);
        const double approach = b[last] - b[plate];
        shift += (a[last] - a[plate]) - approach;
        const double before = std::exchange(through, b[out] - b[plate]);
        const double step = std::abs(before == 0 ? through : before);
        if ((before == 0) != (through == 0) && step >= jump) {
            const double share = std::min(1.0, std::abs(shift) / std::max(std::abs(approach), 1e-300));
            wrong.count += share;
            jumps += share * step;
            squares += share * step * step;
        }
    }
    // of many such samples the root of the squares, of one the jump times its probability
    wrong.norm = std::min(jumps, std::sqrt(squares));
    return wrong;
}

}  // namespace hertzline
