// Random scenes: no NaN, a ledger that closes, the same bits for every block size.

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "core/integrators/stability.hpp"
#include "core/model/energy.hpp"
#include "core/scene/scene_words.hpp"
#include "hertzline/scene_file.hpp"
#include "tests/support/integrators.hpp"
#include "tests/support/runs.hpp"

namespace hertzline::test {
namespace {

double between(double least, double most) {
    constexpr int grains = 1 << 20;
    return least + (most - least) * *rc::gen::inRange(0, grains + 1) / grains;
}

/// Draws a number, evenly spread over the orders of magnitude.
double magnitude_between(double least, double most) {
    return std::exp(between(std::log(least), std::log(most)));
}

/// Draws a number that is often exactly zero, where special cases are.
double zero_or(double value) {
    return *rc::gen::weightedElement<bool>({{1, true}, {3, false}}) ? 0 : value;
}

std::string any_solid() {
    return *rc::gen::element<std::string>("aluminium", "pyrex", "vitreous_carbon", "acrylic",
                                          "silicone_rubber", "steel");
}

Scene any_scene() {
    Scene scene;
    scene.drive.material = any_solid();
    scene.drive.frequency_hz = magnitude_between(10e3, 1e6);
    scene.drive.cycles = *rc::gen::element(0.25, 1.0, 3.0, 5.5, 25.0);
    scene.drive.amplitude_m = zero_or(magnitude_between(1e-9, 10e-6));
    scene.drive.envelope = *rc::gen::element(Envelope::hann, Envelope::tukey, Envelope::rectangular);
    scene.drive.taper = *rc::gen::element(0.0, 0.2, 1.0);
    scene.drive.repetition_hz = zero_or(scene.drive.frequency_hz / scene.drive.cycles * between(0.1, 1));
    scene.chain.material = any_solid();
    scene.chain.spheres = *rc::gen::inRange(1, 41);
    scene.chain.diameter_m = magnitude_between(0.3e-3, 5e-3);
    scene.chain.damping_kg_per_s = zero_or(magnitude_between(1e-3, 2));
    scene.chain.preload_n = zero_or(magnitude_between(1e-4, 10));
    scene.chain.tension = *rc::gen::element(Tension::allowed, Tension::clamped);
    scene.end.kind = *rc::gen::element(EndKind::plate, EndKind::wall, EndKind::free);
    scene.end.material = any_solid();
    scene.end.thickness_m = magnitude_between(0.1e-3, 3e-3);
    scene.end.preload = *rc::gen::element(PlatePreload::balanced, PlatePreload::as_printed);
    scene.chain.damping_law = *rc::gen::elementOf(choices<DampingLaw>);
    scene.chain.damping_time_s = magnitude_between(1e-9, 1e-6);
    scene.chain.damping_alpha = magnitude_between(1e-3, 3);
    scene.numerics.integrator = scene.chain.damping_law == DampingLaw::dashpot
                                    ? *rc::gen::elementOf(choices<Integrator>)
                                    : *rc::gen::elementOf(series_integrators());
    return scene;
}

/// Sets a step that any motion of the scene allows and that resolves the drive, on the sample grid or off it.
Scene with_some_step(Scene scene) {
    const Chain chain(scene);
    const double u = 2 * std::numbers::pi * scene.drive.frequency_hz * scene.drive.amplitude_m;
    Eigen::ArrayXd overlaps = chain.static_overlap;
    for (Eigen::Index c = 0; c < chain.bodies(); ++c) {
        if (chain.stiffness[c] > 0) {
            overlaps[c] += 4 * std::pow(1.25 * u * u / (chain.inv_mass[0] * chain.stiffness[c]), 0.4);
        }
    }
    const double stable = largest_stable_step(chain, overlaps, *scene.numerics.integrator);
    const double step = std::min({stable, 0.1 / scene.drive.frequency_hz, 1e-6}) * between(0.05, 0.2);
    const double steps_per_sample = *rc::gen::element(1.0, 4.0, 3.3, 0.7);
    scene.numerics.step_s = step;
    scene.output.sample_rate_hz = 1 / (step * steps_per_sample);
    return scene;
}

bool finite(const Record& record) {
    const auto all = [](const std::vector<double>& values) {
        return std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
    };
    return all(record.v_last) && all(record.v_plate) && all(record.v_out) && all(record.chain_x) &&
           all(record.chain_v);
}

RC_GTEST_PROP(AnyScene, IsValidAndGivesFiniteSamples, ()) {
    const Scene scene = with_some_step(any_scene());
    RC_LOG(to_toml(scene));
    RC_ASSERT(validate(scene).empty());
    RC_ASSERT(finite(recorded(scene, 1000)));
}

RC_GTEST_PROP(AnyScene, GivesTheSameBitsForEveryBlockSize, ()) {
    const Scene scene = with_some_step(any_scene());
    RC_LOG(to_toml(scene));
    Simulation whole(scene, {.taps = everything});
    Simulation cut(scene, {.taps = everything});
    const Record expected = recorded(whole, 600, 600);
    Record record;
    Samples part = cut.make_samples(100);
    while (record.v_last.size() < 600) {
        const auto left = static_cast<int>(600 - record.v_last.size());
        const auto count = static_cast<std::size_t>(*rc::gen::inRange(1, std::min(left, 100) + 1));
        RC_ASSERT(cut.advance(part, count) == Status::running);
        append(record, part);
    }
    RC_ASSERT(record == expected);
    RC_ASSERT(cut.contact_events() == whole.contact_events());
    RC_ASSERT(cut.energy_residual() == whole.energy_residual());
    RC_ASSERT(cut.ledger().work == whole.ledger().work && cut.ledger().lost == whole.ledger().lost);
}

/// Returns the energy missing in the ledger, relative to the energy that came and went [1].
double missing(const Scene& scene) {
    Simulation simulation(scene);
    Samples part = simulation.make_samples(500);
    for (int i = 0; i < 20; ++i) {
        RC_ASSERT(simulation.advance(part, 100) == Status::running);
    }
    const Ledger ledger = simulation.ledger();
    const double turned_over = ledger.gross_work + ledger.lost + ledger.at_start;
    return turned_over <= 0 ? 0 : simulation.energy_missing() / turned_over;
}

RC_GTEST_PROP(AnyScene, HasALedgerThatCloses, ()) {
    const Scene scene = with_some_step(any_scene());
    RC_LOG(to_toml(scene));
    const double bound = scene.numerics.integrator == Integrator::leapfrog ? 1e-1 : 2e-2;
    const double coarse = missing(scene);
    if (!(coarse <= bound)) {
        // the step may be too coarse for this scene: then the missing energy must fall with the step
        Scene finer = scene;
        finer.numerics.step_s = *scene.numerics.step_s / 8;
        RC_ASSERT(missing(finer) <= coarse / 8);
    }
}

RC_GTEST_PROP(AnyScene, BeyondItsStableStepIsReportedAndGivesNoGarbage, ()) {
    Scene scene = any_scene();
    scene.drive.amplitude_m = magnitude_between(1e-7, 10e-6);
    scene.numerics.step_s = magnitude_between(20e-9, 100e-6);
    scene.output.sample_rate_hz = 1 / *scene.numerics.step_s;
    RC_LOG(to_toml(scene));
    Simulation simulation(scene, {.taps = everything});
    Samples part = simulation.make_samples(50);
    for (int i = 0; i < 20; ++i) {
        const Status status = simulation.advance(part, 50);
        Record record;
        append(record, part);
        RC_ASSERT(finite(record));
        RC_ASSERT((status == Status::unstable) == (part.count == 0));
        RC_ASSERT((status == Status::unstable) == !simulation.failure().empty());
    }
}

}  // namespace
}  // namespace hertzline::test
