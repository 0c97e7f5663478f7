#include "core/numerics.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>

#include "core/simulation.hpp"
#include "core/stability.hpp"

namespace hertzline {

namespace {

constexpr std::int64_t register_spheres = 30;     // four AVX-512 registers
constexpr std::int64_t pilot_spheres = 128;       // what a longer chain does is decided near the horn
constexpr double most_body_steps = 1e6;           // of the coarsest pilot,
constexpr double most_body_steps_together = 3e7;  // and of all of them: about a second at worst
constexpr double first_phase = 0.6;               // omega h of the coarsest pilot: surely stable
constexpr double drive_periods = 1.0 / 20;        // and it resolves the drive
constexpr double bursts_watched = 1.5;            // the chain rings on after the burst
constexpr int most_halvings = 8;
constexpr double safety =
    0.5;  // of the wanted accuracy: where contacts switch, errors scatter about their power law
constexpr double chaotic = 0.05;  // an error that halving does not bring below this is no truncation error

/// Upper estimate of the overlaps before anything was simulated: the static ones and what an impact at the
/// horn's largest velocity adds (Johnson 1985, eq. 11.2: (15 m u^2 / 16 k')^(2/5), here with k = 4/3 k').
Eigen::ArrayXd expected_overlaps(const Chain& chain, const Drive& drive) {
    const double u = 2 * std::numbers::pi * drive.frequency_hz * drive.amplitude_m;
    Eigen::ArrayXd overlaps = chain.static_overlap;
    for (Eigen::Index c = 0; c < chain.bodies(); ++c) {
        if (chain.stiffness[c] > 0) {
            overlaps[c] += std::pow(1.25 * u * u / (chain.inv_mass[0] * chain.stiffness[c]), 0.4);
        }
    }
    return overlaps;
}

/// Velocities over a pilot, [sample][body], and the overlaps it reached.
struct Pilot {
    std::vector<double> velocities;
    Eigen::ArrayXd peak_overlap;
    bool stable = true;
};

struct PilotPlan {
    Scene scene;
    std::size_t samples;
    double sample_period_s;
};

Pilot fly(const PilotPlan& plan, double step_s) {
    Scene scene = plan.scene;
    scene.numerics.step_s = step_s;
    scene.output.sample_rate_hz = 1 / plan.sample_period_s;
    constexpr std::size_t block = 256;
    const Wish wish{.outputs = true, .chain_velocities = true, .chain_displacements = false};
    Simulation simulation(scene, wish);
    Samples part(simulation.chain(), block, wish);
    Pilot result;
    for (std::size_t done = 0; done < plan.samples && result.stable; done += block) {
        result.stable =
            simulation.advance(part, std::min(block, plan.samples - done), wish) == Status::running;
        for (std::size_t i = 0; i < part.count; ++i) {
            const double* row = part.chain_v.data() + i * part.spheres;
            result.velocities.insert(result.velocities.end(), row, row + part.spheres);
            result.velocities.push_back(part.v_plate.empty() ? 0 : part.v_plate[i]);
        }
    }
    result.peak_overlap = simulation.state().peak_overlap;
    return result;
}

/// Largest relative L2 difference of any body's velocity. Bodies that hardly move are judged by the scale of
/// the others.
double largest_difference(const Pilot& coarse, const Pilot& fine, std::size_t bodies) {
    if (!coarse.stable || !fine.stable) {
        return std::numeric_limits<double>::infinity();
    }
    Eigen::ArrayXd difference = Eigen::ArrayXd::Zero(static_cast<Eigen::Index>(bodies));
    Eigen::ArrayXd norm = difference;
    for (std::size_t i = 0; i < fine.velocities.size(); ++i) {
        const double d = coarse.velocities[i] - fine.velocities[i];
        difference[static_cast<Eigen::Index>(i % bodies)] += d * d;
        norm[static_cast<Eigen::Index>(i % bodies)] += fine.velocities[i] * fine.velocities[i];
    }
    constexpr double hardly = 1e-6;  // of the largest energy
    const double largest = norm.maxCoeff();
    return largest > 0 ? std::sqrt((difference / norm.max(hardly * largest)).maxCoeff()) : 0;
}

/// The largest step not above `step` that divides the sample period or, beyond it, is a multiple of a quarter
/// of it.
double fitted_to_samples(double step, double sample_rate_hz) {
    const double per_sample = 1 / (sample_rate_hz * step);
    constexpr double slack = 1e-9;
    if (per_sample >= 1 - slack) {
        return 1 / (sample_rate_hz * std::ceil(per_sample * (1 - slack)));
    }
    return std::floor(4 / per_sample * (1 + slack)) / (4 * sample_rate_hz);
}

PilotPlan plan_pilot(const Scene& asked, double first_step) {
    Scene scene = asked;
    scene.chain.spheres = std::min(scene.chain.spheres, pilot_spheres);
    const double watched = bursts_watched * scene.drive.cycles / scene.drive.frequency_hz;
    const double affordable = most_body_steps / static_cast<double>(scene.chain.spheres + 1);
    const double samples = std::clamp(std::ceil(watched / first_step), 16.0, affordable);
    return {scene, static_cast<std::size_t>(samples), first_step};
}

double coarsest_step(const Scene& scene) {
    const Chain chain(scene);
    const double omega = fastest_frequency(chain, expected_overlaps(chain, scene.drive));
    const double by_drive = drive_periods / scene.drive.frequency_hz;
    const double stable =
        largest_stable_step(chain, expected_overlaps(chain, scene.drive), *scene.numerics.integrator);
    return std::min({first_phase / omega, by_drive, stable / 2});
}

}  // namespace

Scene with_integrator(Scene scene) {
    if (!scene.numerics.integrator) {
        const bool short_chain = scene.chain.spheres <= register_spheres;
        scene.numerics.integrator = short_chain ? Integrator::chin4a : Integrator::leapfrog;
    }
    return scene;
}

StepAdvice advise_step(const Scene& asked) {
    const Scene scene = with_integrator(asked);
    const double target = safety * scene.numerics.accuracy.value_or(default_accuracy);
    const double first = coarsest_step(scene);
    const PilotPlan plan = plan_pilot(scene, first);
    const auto bodies = static_cast<std::size_t>(plan.scene.chain.spheres) + 1;

    StepAdvice advice;
    advice.pilot_duration_s = static_cast<double>(plan.samples) * plan.sample_period_s;
    double step = first;
    double coarser_error = 0;
    double error = 0;
    double taken = 0;
    Pilot coarse = fly(plan, step);
    for (int halvings = 0;; ++halvings) {
        Pilot fine = fly(plan, step / 2);
        coarser_error = error;
        // what remains at half the step is at most a third of the difference, by the lowest order in use
        // (two)
        error = largest_difference(coarse, fine, bodies) * 4 / 3;
        coarse = std::move(fine);
        taken += 2 * static_cast<double>(plan.samples * bodies) * std::exp2(halvings + 1);
        if (error <= target || halvings == most_halvings || taken > most_body_steps_together) {
            break;
        }
        step /= 2;
    }
    const Chain chain(plan.scene);
    advice.largest_stable_step_s =
        largest_stable_step(chain, coarse.peak_overlap, *scene.numerics.integrator);
    advice.accuracy_met = error <= target;
    if (advice.accuracy_met && coarser_error > 0 && std::isfinite(coarser_error) && error > 0) {
        // between the step that is good enough and its double, which is not: a power law through both errors
        const double order = std::log2(coarser_error / error);
        const double growth = std::clamp(std::pow(target / error, 1 / order), 1.0, 2.0);
        step *= growth;
        error *= std::pow(growth, order);
    } else if (!advice.accuracy_met && error > chaotic) {
        step = first / 4;
    }
    advice.recommended_step_s = fitted_to_samples(step, scene.output.sample_rate_hz);
    advice.estimated_error = error;
    return advice;
}

Resolved resolved(const Scene& asked) {
    Resolved result{with_integrator(asked), advise_step(asked), {}};
    Numerics& numerics = result.scene.numerics;
    numerics.accuracy.reset();
    if (!numerics.step_s) {
        numerics.step_s = result.advice.recommended_step_s;
        return result;
    }
    const double limit = result.advice.largest_stable_step_s;
    if (*numerics.step_s > limit) {
        std::array<char, 64> found{};
        std::array<char, 128> allowed{};
        std::snprintf(found.data(), found.size(), "%.9g", *numerics.step_s);
        std::snprintf(allowed.data(), allowed.size(),
                      "at most %.4g s, the stability limit in this scene (recommended: %.4g s)", limit,
                      result.advice.recommended_step_s);
        result.faults.push_back({"numerics.step_s", found.data(), allowed.data()});
    }
    return result;
}

}  // namespace hertzline
