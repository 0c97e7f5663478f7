#pragma once
// Leapfrog with fractional contact in textbook form, to compare the kernels with: no SIMD, no folding, and static
// forces included. Written from the model's equations; takes only constants from Chain.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/model/chain.hpp"

namespace hertzline::test {

class Textbook {
public:
    Textbook(const Scene& scene, double step_s)
        : chain_(scene),
          drive_(scene.drive),
          gravity_(scene.chain.gravity_m_per_s2),
          h_(step_s),
          x(size()),
          v(size()),
          force_(size() + 1) {
        std::fill_n(v.begin(), chain_.impact_spheres, chain_.impact_velocity);
    }

    void step() {
        const double begin = static_cast<double>(steps_) * h_;
        const double left = drive_.cycles / drive_.frequency_hz - begin;  // of the burst [s]
        if (left > 0 && left < h_) {
            part(begin, left);
            part(begin + left, h_ - left);
        } else {
            part(begin, h_);
        }
        ++steps_;
    }

private:
    struct Horn {
        double x, v;
    };
    /// Takes a step of length h, in which the horn's motion is smooth.
    void part(double begin, double h) {
        const Horn middle = horn(begin + h / 2);
        drift(h);
        contacts(v, middle, h);
        std::vector<double> half = v;
        kick(half, h / 2, v);
        contacts(half, middle, h);
        kick(v, h, half);
        drift(h);
    }

    std::size_t size() const { return static_cast<std::size_t>(chain_.bodies()); }

    /// Returns a Hann burst (docs/model.md, section 5).
    Horn horn(double t) const {
        const double duration = drive_.cycles / drive_.frequency_hz;
        if (t <= 0 || t >= duration || drive_.kind == DriveKind::none) {
            return {0, 0};
        }
        const double carrier = 2 * std::numbers::pi * drive_.frequency_hz;
        const double slow = 2 * std::numbers::pi / duration;
        const double envelope = (1 - std::cos(slow * t)) / 2;
        return {drive_.amplitude_m * envelope * std::sin(carrier * t),
                drive_.amplitude_m * (slow * std::sin(slow * t) / 2 * std::sin(carrier * t) +
                                      envelope * carrier * std::cos(carrier * t))};
    }

    /// Drifts for half of h.
    void drift(double h) {
        for (std::size_t b = 0; b < size(); ++b) {
            x[b] += h / 2 * v[b];
        }
    }

    /// Computes the contact forces f_c (docs/model.md, section 3), with dashpots weighted by the part of the step in
    /// contact.
    void contacts(const std::vector<double>& u, const Horn& horn, double h) {
        for (std::size_t c = 0; c < size(); ++c) {
            const auto i = static_cast<Eigen::Index>(c);
            const double overlap = chain_.static_overlap[i] + (c > 0 ? x[c - 1] : horn.x) - x[c];
            const double w = (c > 0 ? u[c - 1] : horn.v) - u[c];
            const double way = std::abs(w) * h;
            const double part = way > 0 ? std::clamp(0.5 + overlap / way, 0.0, 1.0) : 0;
            force_[c] =
                chain_.stiffness[i] * std::pow(std::max(overlap, 0.0), 1.5) + chain_.damping[i] * w * part;
            if (chain_.tension == Tension::clamped) {
                force_[c] = std::max(force_[c], 0.0);
            }
        }
        if (chain_.end.loaded == EndLoad::last_sphere) {
            force_[size() - 1] = chain_.end_force_n;
        }
        if (drive_.kind == DriveKind::none) {
            force_[0] = chain_.preload_n;
        }
    }

    /// Applies the equations of motion (docs/model.md, section 4) to the velocities at the start. @param in_holder by which the holder slows
    void kick(std::vector<double>& u, double time, const std::vector<double>& in_holder) const {
        for (std::size_t b = 0; b < size(); ++b) {
            const auto i = static_cast<Eigen::Index>(b);
            const bool is_end = b + 1 == size();
            const double from_right =
                !is_end ? force_[b + 1] : chain_.spring[i] * x[b] + chain_.end_force_n - chain_.bias[i];
            const double of_itself = is_end ? 0 : gravity_ - chain_.holder_rate * in_holder[b];
            u[b] = v[b] + time * (chain_.inv_mass[i] * (force_[b] - from_right) + of_itself);
        }
    }

    Chain chain_;
    Drive drive_;
    double gravity_;
    double h_;
    long steps_ = 0;

public:
    std::vector<double> x, v;  ///< displacements [m] and velocities [m/s] of all bodies

private:
    std::vector<double> force_;  ///< of each contact [N]
};

}  // namespace hertzline::test
