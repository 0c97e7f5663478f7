#include "core/step_choice/pilot.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/model/end.hpp"
#include "core/plate/plate_response.hpp"
#include "core/scene/elements.hpp"

namespace hertzline {

namespace {

/// Stretches are chosen so that they take fewer; pieces of a series may be far shorter than foreseen.
constexpr double far_too_many_body_steps = 8 * affordable_body_steps;

/// Kept beside the spheres' velocities, in this order.
std::vector<Tap> outputs_of(const Scene& scene) {
    if (provides(scene, Requires::lumped_plate)) {
        return {Tap::v_plate, Tap::v_out};
    }
    std::vector<Tap> outputs;
    if (provides(scene, Requires::modal_plate)) {
        outputs = {Tap::v_centre, Tap::v_face, Tap::p_axis};
    }
    if (provides(scene, Requires::points)) {
        outputs.push_back(Tap::p_points);
    }
    return outputs;
}

SimulationOptions options_of_pilots(const Scene& scene, const std::atomic<bool>* stop) {
    const double bodies = static_cast<double>(scene.chain.spheres) + 1;
    TapSet taps = Tap::v_chain;
    for (const Tap tap : outputs_of(scene)) {
        taps |= tap;
    }
    return {.taps = taps,
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

Scene with_another_fit(Scene scene, double accuracy, std::size_t other) {
    if (!provides(scene, Requires::modal_plate)) {
        return scene;
    }
    constexpr int as_fine = 52;
    const PlateParameters parameters = plate_parameters(scene);
    const int given = plate_poles(scene);
    const double error = plate_response(parameters, given)->fit_error();
    const double share = is_array(scene) || given >= as_fine ? 10 : 1;
    auto poles = fine_poles(parameters, given, share * error, other);
    if (!poles && scene.medium.load != FluidLoad::none) {  // of a plate in a vacuum few poles are exact
        poles = fine_poles(parameters, given, accuracy / 3, other);
    }
    scene.numerics.poles = poles.value_or(given);
    return scene;
}

Scene with_few_points(Scene scene) {
    constexpr std::size_t most = 64;
    std::vector<std::array<double, 3>>& points = scene.output.points_m;
    if (points.size() > most) {
        for (std::size_t i = 0; i < most; ++i) {
            points[i] = points[i * (points.size() - 1) / (most - 1)];
        }
        points.resize(most);
    }
    return scene;
}

double velocity_per_unit(Tap tap, const EndModel& end) noexcept {
    if (row_of(tap).unit != "Pa") {
        return 1;
    }
    const Fluid& fluid = end.plate->parameters.fluid;
    return 1 / (fluid.density_kg_per_m3 * fluid.sound_speed_m_per_s);
}

Pilot::Pilot(const Scene& scene, Integrator integrator, double step_s, const std::atomic<bool>* stop)
    : simulation_(with_step(with_few_points(scene), integrator, step_s), options_of_pilots(scene, stop)),
      block_(simulation_.make_samples(pilot_block)),
      spheres_(block_.spheres()),
      columns_(static_cast<std::size_t>(channels_of(block_.taps(), block_.counts()))),
      event_rate_(scene.drive) {
    for (const Tap tap : outputs_of(scene)) {
        outputs_.push_back({tap, block_.channels(tap), velocity_per_unit(tap, simulation_.chain().end)});
    }
}

void Pilot::run_to(std::size_t samples, double most_body_steps) {
    const double most_steps = most_body_steps / static_cast<double>(spheres_ + 1);
    const std::size_t block = std::isfinite(most_steps) ? counted_block : pilot_block;
    if (const std::size_t needed = samples * columns_; needed > velocities_.capacity()) {
        velocities_.reserve(std::max(needed, 2 * velocities_.capacity()));
    }
    while (stable_ && this->samples() < samples && static_cast<double>(steps()) < most_steps) {
        const std::size_t wanted = std::min(block, samples - this->samples());
        stable_ = simulation_.advance(block_, wanted) == Status::running;
        const std::size_t before = velocities_.size();
        velocities_.resize(before + block_.count * columns_);
        auto out = velocities_.begin() + static_cast<std::ptrdiff_t>(before);
        for (std::size_t i = 0; i < block_.count; ++i) {
            out = std::ranges::copy(block_[Tap::v_chain].subspan(i * spheres_, spheres_), out).out;
            for (const Output& output : outputs_) {
                out = std::ranges::transform(block_[output.tap].subspan(i * output.channels, output.channels),
                                             out, [&output](double value) { return output.scale * value; })
                          .out;
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
