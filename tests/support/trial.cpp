#include "tests/support/trial.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/integrators/stability.hpp"
#include "core/model/contact_law.hpp"
#include "core/model/energy.hpp"
#include "core/step_choice/step_advice.hpp"
#include "hertzline/resolve.hpp"
#include "hertzline/simulation.hpp"

namespace hertzline::test {

namespace {

bool finite(const Samples& block) {
    bool all = true;
    for (const Tap tap : block.holds) {
        all = all && std::ranges::all_of(block[tap], [](double v) { return std::isfinite(v); });
    }
    return all;
}

/// Returns the number of steps that a run needs, from its rates of change, its contact events and its step.
double steps_called_for(const Scene& scene, Simulation& simulation) {
    const Chain& chain = simulation.chain();
    const double rates = fastest_frequency(chain, simulation.state().peak_overlap) +
                         2 * fastest_decay(chain, simulation.state().peak_overlap) +
                         2 * std::numbers::pi * scene.drive.frequency_hz;
    const double bursts = scene.drive.repetition_hz * simulation.time_s();
    return 10 + simulation.time_s() * (rates + 1 / simulation.step_s()) + 4 * bursts +
           static_cast<double>(simulation.contact_events());
}

bool names(const std::string& message, const std::string& what) {
    return message.find(what) != std::string::npos;
}

void judge_stop(Trial& trial, std::size_t samples_in_block) {
    trial.outcome = Outcome::stopped;
    if (samples_in_block != 0) {
        trial.findings.emplace_back("the block in which it stopped is not empty");
    }
    const bool says = (names(trial.message, "step") || names(trial.message, "piece")) &&
                      names(trial.message, "t = ") && names(trial.message, "contact ");
    if (!says || names(trial.message, "nan") || names(trial.message, "inf")) {
        trial.findings.push_back("it stopped without step, time and contact: " + trial.message);
    }
}

Trial run(const Scene& scene) {
    constexpr double max_crowded = 40;
    constexpr std::size_t block = 64;
    Trial trial;
    trial.integrator = *scene.numerics.integrator;
    Simulation simulation(scene, {.taps = all_taps});
    Samples part = simulation.make_samples(block);
    const double samples = std::clamp(scene.output.duration_s * scene.output.sample_rate_hz, 1.0, 20e3);
    while (static_cast<double>(simulation.next_sample()) < samples) {
        const Status status = simulation.advance(part, block);
        if (!finite(part)) {
            trial.findings.emplace_back("a sample is not finite");
            break;
        }
        trial.steps = simulation.steps();
        if (status != Status::running) {
            trial.message = simulation.failure();
            judge_stop(trial, part.count);
            break;
        }
        trial.crowding = static_cast<double>(trial.steps) / steps_called_for(scene, simulation);
        if (trial.crowding > max_crowded) {
            trial.findings.emplace_back("pieces collapse");
            break;
        }
    }
    trial.simulated_s = simulation.time_s();
    const Ledger ledger = simulation.ledger();
    const double pressed =
        elastic_energy(simulation.chain().stiffness[0], simulation.state().peak_overlap[0]);
    // a billionth of the horn's speed is rounding
    const double horn_speed = 2 * std::numbers::pi * scene.drive.frequency_hz * scene.drive.amplitude_m;
    const double rounding = 0.5 / simulation.chain().inv_mass[0] * std::pow(1e-9 * horn_speed, 2);
    const double turned_over =
        ledger.gross_work + ledger.lost + std::abs(ledger.at_start) + pressed + rounding;
    trial.residual = turned_over <= 0 ? 0 : simulation.energy_missing() / turned_over;
    if (trial.outcome == Outcome::ran && !std::isfinite(trial.residual)) {
        trial.findings.emplace_back("the ledger is not finite");
    }
    return trial;
}

/// Returns whether the method resolves the horn: none on a grid resolves a rise or fall within a step.
bool is_resolved(const Scene& scene) {
    const Drive& drive = scene.drive;
    if (is_series(*scene.numerics.integrator)) {
        return true;
    }
    const bool ramps = drive.envelope == Envelope::tukey && drive.taper > 0;
    const double piece_s = (ramps ? drive.taper / 2 : 1) * drive.cycles / drive.frequency_hz;
    return piece_s > *scene.numerics.step_s;
}

}  // namespace

Trial tried(const Scene& asked) {
    Scene scene = with_integrator(asked);
    Trial trial;
    trial.integrator = *scene.numerics.integrator;
    if (scene.numerics.step_s) {
        // resolve() refuses more, but only after a pilot
        constexpr double hopeless = 30;
        const Chain chain(scene);
        const double limit = largest_stable_step(chain, chain.static_overlap, trial.integrator);
        if (*scene.numerics.step_s > hopeless * limit) {
            trial.outcome = Outcome::refused;
            return trial;
        }
    } else {
        const Resolution result = resolve(asked);
        scene = result.scene;
        if (!result.faults.empty()) {
            trial.outcome = Outcome::refused;
            trial.message = result.faults.front().key + " " + result.faults.front().allowed;
            return trial;
        }
        if (!(*scene.numerics.step_s > 0)) {
            trial.findings.emplace_back("no step was found");
            return trial;
        }
    }
    constexpr double steps_between_looks = 50;
    double& rate = scene.output.sample_rate_hz;
    rate = std::max(rate, 1 / (steps_between_looks * *scene.numerics.step_s));
    trial = run(scene);
    const double bound = trial.integrator == Integrator::leapfrog ? 1e-1 : 2e-2;
    if (trial.outcome != Outcome::ran || trial.residual <= bound || !is_resolved(scene)) {
        return trial;
    }
    // if the missing energy falls with the step, the step was only too coarse for this scene
    constexpr int max_refinements = 3;
    Trial fine = trial;
    for (int i = 0; i < max_refinements && !(fine.residual <= bound); ++i) {
        *scene.numerics.step_s /= 8;
        fine = run(scene);
    }
    if (!(fine.residual <= bound)) {
        trial.findings.push_back("energy is missing: " + std::to_string(trial.residual) +
                                 ", with a much shorter step " + std::to_string(fine.residual));
    }
    return trial;
}

}  // namespace hertzline::test
