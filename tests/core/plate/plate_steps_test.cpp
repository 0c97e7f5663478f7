// A modal plate in the steps of a grid, on its own: what drifts and kicks do to its states.

#include "core/plate/plate_steps.hpp"

#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "core/model/end.hpp"
#include "tests/support/modal_scenes.hpp"

namespace hertzline::test {
namespace {

std::shared_ptr<const PlateResponse> response() {
    return plate_response(plate_parameters(modal_scene()), 40);
}

/// Pushed by a constant force.
void push(PlateSteps& plate, double force, double step_s, int steps) {
    for (int i = 0; i < steps; ++i) {
        plate.begin();
        plate.drift(0.5 * step_s);
        plate.kick(plate.velocity() + plate.mobility() * force * step_s);
        plate.drift(0.5 * step_s);
        plate.accept_kicked(step_s);
    }
}

TEST(PlateSteps, AConstantForceBendsThePlateByTheComplianceOfItsModes) {
    const auto plate = response();
    double compliance = 0;
    for (const PlateMode& mode : plate->modes) {
        compliance += 1 / mode.stiffness_n_per_m;
    }
    constexpr double force = 0.7;
    constexpr double step_s = 20e-9;
    PlateSteps steps(*plate, step_s, nullptr);
    push(steps, force, step_s, 500000);
    EXPECT_NEAR(steps.displacement(), force * compliance, 1e-4 * force * compliance);
    EXPECT_NEAR(steps.energy(), 0.5 * force * force * compliance, 1e-3 * force * force * compliance);
    EXPECT_GE(steps.passed() - steps.lost() - steps.energy(), 0);  // radiated
}

TEST(PlateSteps, ItRingsOnItsOwnTheSameWithAnyStep) {
    const auto plate = response();
    const auto after = [&](double step_s, int steps) {
        PlateSteps motion(*plate, step_s, nullptr);
        motion.begin();
        motion.kick(1);
        for (int i = 0; i < steps; ++i) {
            motion.drift(step_s);
        }
        return std::array{motion.displacement(), motion.velocity()};
    };
    const auto once = after(3e-6, 1);
    const auto often = after(3e-9, 1000);
    EXPECT_NEAR(often[0], once[0], 1e-12 * std::abs(once[0]));
    EXPECT_NEAR(often[1], once[1], 1e-11);
}

TEST(PlateSteps, ADashpotsForceInADriftIsWorthAsManyKicks) {
    // a force t^n / n! over the drift, of which the derivatives tell
    const auto plate = response();
    constexpr double time = 80e-9;
    for (int power = 0; power < 4; ++power) {
        PlateSteps drifting(*plate, time, nullptr);
        drifting.begin();
        drifting.begin_drift(time);
        for (int p = 1; p <= 4; ++p) {
            drifting.derivative(p, p == power + 1 ? 1 : 0);
        }
        drifting.end_drift();
        constexpr int kicks = 4000;
        PlateSteps kicked(*plate, time / kicks, nullptr);
        kicked.begin();
        for (int i = 0; i < kicks; ++i) {
            const double z = (i + 0.5) / kicks;
            kicked.drift(0.5 * time / kicks);
            kicked.kick(kicked.velocity() + std::pow(z, power) / std::tgamma(power + 1.0) / kicks);
            kicked.drift(0.5 * time / kicks);
        }
        EXPECT_NEAR(drifting.displacement(), kicked.displacement(), 1e-6 * kicked.displacement()) << power;
        EXPECT_NEAR(drifting.velocity(), kicked.velocity(), 1e-6 * std::abs(kicked.velocity())) << power;
    }
}

}  // namespace
}  // namespace hertzline::test
