// Bursts of every shape: the integration follows the horn's breaks without losing its order.

#include <cmath>
#include <numeric>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/integrators.hpp"
#include "tests/support/reference.hpp"
#include "tests/support/runs.hpp"

namespace hertzline::test {
namespace {

struct Shape {
    std::string name;
    Envelope envelope;
    double cycles;
    double taper;
    double repetition_hz;
};

class EveryShape : public ::testing::TestWithParam<Shape> {
protected:
    static constexpr std::size_t samples = 3000;

    Scene scene() const {
        Scene scene;
        scene.drive.envelope = GetParam().envelope;
        scene.drive.cycles = GetParam().cycles;
        scene.drive.taper = GetParam().taper;
        scene.drive.repetition_hz = GetParam().repetition_hz;
        return scene;
    }

    /// Returns the errors at 100, 50, 25, 12.5 ns; none of the breaks lies on a step.
    std::vector<double> errors(Integrator integrator) const {
        const Record fine = recorded(with_step(scene(), Integrator::taylor12, 200e-9), samples);
        std::vector<double> all;
        for (const double step : {100e-9, 50e-9, 25e-9, 12.5e-9}) {
            all.push_back(
                relative_l2(recorded(with_step(scene(), integrator, step), samples).v_last, fine.v_last));
        }
        return all;
    }
};

INSTANTIATE_TEST_SUITE_P(Shapes, EveryShape,
                         ::testing::Values(Shape{"hann_one_cycle", Envelope::hann, 1, 0, 0},
                                           Shape{"hann_half_a_cycle", Envelope::hann, 0.5, 0, 0},
                                           Shape{"rectangular", Envelope::rectangular, 5, 0, 0},
                                           Shape{"rectangular_one_cycle", Envelope::rectangular, 1, 0, 0},
                                           Shape{"tukey", Envelope::tukey, 7.3, 0.2, 0},
                                           Shape{"tukey_steep", Envelope::tukey, 5.3, 0.01, 0},
                                           Shape{"tukey_as_hann", Envelope::tukey, 5.5, 1, 0},
                                           Shape{"rectangular_repeated", Envelope::rectangular, 3, 0, 11e3},
                                           Shape{"hann_without_a_pause", Envelope::hann, 3, 0, 73e3 / 3},
                                           Shape{"tukey_repeated", Envelope::tukey, 4.2, 0.5, 13.7e3}),
                         [](const auto& instance) { return instance.param.name; });

/// Returns the mean order over all halvings.
double order(const std::vector<double>& errors) {
    return std::log2(errors.front() / errors.back()) / static_cast<double>(errors.size() - 1);
}

TEST_P(EveryShape, ConvergesFasterThanSecondOrderWhereContactsAreLocated) {
    const std::vector<double> e = errors(Integrator::chin4a);
    EXPECT_GE(order(e), 2.2) << ::testing::PrintToString(e);
    EXPECT_LE(e[1], 1e-4) << ::testing::PrintToString(e);
}

TEST_P(EveryShape, IsSolvedByASeriesToTheLastDigits) {
    const Record fine = recorded(with_step(scene(), Integrator::chin4a, 1e-9), samples);
    for (const Integrator integrator : {Integrator::taylor8, Integrator::taylor12}) {
        const Record record = recorded(with_step(scene(), integrator, 400e-9), samples);
        EXPECT_LE(relative_l2(record.v_last, fine.v_last), 3e-9) << word(integrator);
    }
}

TEST_P(EveryShape, LeapfrogConvergesWithSecondOrder) {
    const std::vector<double> e = errors(Integrator::leapfrog);
    EXPECT_NEAR(order(e), 2, 0.25) << ::testing::PrintToString(e);
    EXPECT_LE(e[3], 1.5e-3) << ::testing::PrintToString(e);
}

TEST(ABurstThatStopsAmidACycle, ConvergesThoughTheHornJumps) {
    Scene scene;
    scene.drive.envelope = Envelope::rectangular;
    scene.drive.cycles = 4.25;
    const Record fine = recorded(with_step(scene, Integrator::taylor12, 200e-9), 2000);
    const auto error = [&](Integrator integrator, double step) {
        return relative_l2(recorded(with_step(scene, integrator, step), 2000).v_last, fine.v_last);
    };
    for (const Integrator integrator : locating_integrators()) {
        EXPECT_LE(error(integrator, 50e-9), 1e-5) << word(integrator);
    }
    EXPECT_LE(error(Integrator::leapfrog, 12.5e-9), 1e-2);
}

TEST(Drive, TheMeanOfTheHornIsZeroSoTheChainComesBack) {
    // after the last burst a damped chain returns to where it was
    for (const Integrator integrator : choices<Integrator>) {
        Scene scene = with_step(Scene{}, integrator, 50e-9);
        scene.end.kind = EndKind::wall;
        scene.chain.damping_kg_per_s = 1;
        Simulation simulation(scene);
        EXPECT_EQ(simulation.skip(50'000), Status::running);
        EXPECT_LE(simulation.state().x.abs().maxCoeff(), 1e-22);
        EXPECT_LE(simulation.state().v.abs().maxCoeff(), 1e-20);
    }
}

TEST(Repetition, TheChainSettlesIntoTheSameAnswerToEveryBurst) {
    // ringing of one burst meets the next (6e-3 of it), but is the same for all later ones
    Scene scene;
    scene.drive.repetition_hz = 1000;
    const Record record = recorded(with_step(scene, Integrator::chin4a, 50e-9), 40000);
    const auto change = [&](std::size_t burst) {
        double difference = 0;
        double norm = 0;
        for (std::size_t i = 0; i < 10000; ++i) {
            difference +=
                std::pow(record.v_out[10000 * burst + i] - record.v_out[10000 * (burst - 1) + i], 2);
            norm += std::pow(record.v_out[i], 2);
        }
        return std::sqrt(difference / norm);
    };
    EXPECT_LT(change(1), 2e-2);
    EXPECT_LT(change(2), 1e-3);
    EXPECT_LT(change(3), 1e-3);
}

TEST(Envelope, EveryOneConvergesWithTheStep) {
    struct Case {
        Envelope envelope;
        double cycles;
        double frequency_hz;
    };
    for (const Case& c : {Case{Envelope::rectangular, 5, 73e3}, Case{Envelope::rectangular, 4.25, 73e3},
                          Case{Envelope::tukey, 5.3, 73e3}, Case{Envelope::hann, 1, 73e3}}) {
        for (const auto& [integrator, bound] :
             {std::pair{Integrator::chin4a, 2e-4}, {Integrator::leapfrog, 2e-3}}) {
            Scene scene;
            scene.drive.envelope = c.envelope;
            scene.drive.cycles = c.cycles;
            scene.drive.frequency_hz = c.frequency_hz;
            const Record fine = recorded(with_step(scene, Integrator::chin4a, 2.5e-9), 1500);
            const Record coarse = recorded(with_step(scene, integrator, 25e-9), 1500);
            EXPECT_LT(relative_l2(coarse.v_last, fine.v_last), bound)
                << c.cycles << ' ' << static_cast<int>(c.envelope);
        }
    }
}

}  // namespace
}  // namespace hertzline::test
