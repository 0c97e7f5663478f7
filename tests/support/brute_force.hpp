#pragma once
// A chain with any law of damping in textbook form, to compare the series with. An adaptive method of order 5 integrates it without
// regard to contacts: it takes tiny steps where they open and close. Takes only constants from Chain.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <boost/numeric/odeint.hpp>

#include "core/model/chain.hpp"

namespace hertzline::test {

class BruteForce {
public:
    explicit BruteForce(const Scene& scene) : scene_(scene), chain_(scene), state_(2 * bodies()) {}

    /// Returns the velocities of all bodies, sample after sample from t = 0 on [m/s].
    std::vector<double> velocities(std::size_t samples) {
        namespace odeint = boost::numeric::odeint;
        constexpr double absolute = 1e-17;  // [m] and [m/s]
        constexpr double relative = 1e-13;
        auto stepper =
            odeint::make_controlled(absolute, relative, odeint::runge_kutta_dopri5<std::vector<double>>());
        const double period = 1 / scene_.output.sample_rate_hz;
        std::vector<double> result;
        for (std::size_t i = 0; i < samples; ++i) {
            if (i > 0) {
                const double from = static_cast<double>(i - 1) * period;
                odeint::integrate_adaptive(
                    stepper, [this](const auto& y, auto& slope, double t) { differentiate(y, slope, t); },
                    state_, from, from + period, period / 100);
            }
            result.insert(result.end(), state_.begin() + static_cast<std::ptrdiff_t>(bodies()), state_.end());
        }
        return result;
    }

    std::size_t bodies() const { return static_cast<std::size_t>(chain_.bodies()); }

private:
    struct Horn {
        double x, v;
    };

    /// Returns a Hann burst (docs/model.md, section 5).
    Horn horn(double t) const {
        const Drive& drive = scene_.drive;
        const double duration = drive.cycles / drive.frequency_hz;
        if (t <= 0 || t >= duration) {
            return {0, 0};
        }
        const double carrier = 2 * std::numbers::pi * drive.frequency_hz;
        const double slow = 2 * std::numbers::pi / duration;
        const double envelope = (1 - std::cos(slow * t)) / 2;
        return {drive.amplitude_m * envelope * std::sin(carrier * t),
                drive.amplitude_m * (slow * std::sin(slow * t) / 2 * std::sin(carrier * t) +
                                     envelope * carrier * std::cos(carrier * t))};
    }

    /// Computes the contact forces (docs/model.md, section 3).
    double force(std::size_t c, double overlap, double approach) const {
        if (overlap <= 0) {
            return 0;
        }
        const Spheres& spheres = scene_.chain;
        const double k = chain_.stiffness[static_cast<Eigen::Index>(c)];
        const bool between_spheres = c > 0 && c + 1 < bodies();
        const double mass = (between_spheres ? 0.5 : 1) / chain_.inv_mass[0];
        double f = k * std::pow(overlap, 1.5);
        switch (spheres.damping_law) {
            case DampingLaw::dashpot:
                f += spheres.damping_kg_per_s * approach;
                break;
            case DampingLaw::kuwabara_kono:
                f += k * 1.5 * *spheres.damping_time_s * std::sqrt(overlap) * approach;
                break;
            case DampingLaw::tsuji:
                f += *spheres.damping_alpha * std::sqrt(mass * k) * std::pow(overlap, 0.25) * approach;
                break;
        }
        return spheres.tension == Tension::clamped ? std::max(f, 0.0) : f;
    }

    /// Computes the equations of motion (docs/model.md, section 4).
    void differentiate(const std::vector<double>& y, std::vector<double>& slope, double t) const {
        const Horn left = horn(t);
        const std::size_t n = bodies();
        std::vector<double> forces(n + 1);
        for (std::size_t c = 0; c < n; ++c) {
            const auto i = static_cast<Eigen::Index>(c);
            const double overlap = chain_.static_overlap[i] + (c > 0 ? y[c - 1] : left.x) - y[c];
            forces[c] = force(c, overlap, (c > 0 ? y[n + c - 1] : left.v) - y[n + c]);
        }
        if (scene_.end.kind == EndKind::free) {
            forces[n - 1] = chain_.preload_n;
        }
        const auto end = static_cast<Eigen::Index>(n - 1);
        forces[n] = chain_.spring[end] * y[n - 1] + chain_.preload_n - chain_.bias[end];
        for (std::size_t b = 0; b < n; ++b) {
            slope[b] = y[n + b];
            slope[n + b] = chain_.inv_mass[static_cast<Eigen::Index>(b)] * (forces[b] - forces[b + 1]);
        }
    }

    Scene scene_;
    Chain chain_;
    std::vector<double> state_;  ///< displacements [m] and velocities [m/s] of all bodies
};

}  // namespace hertzline::test
