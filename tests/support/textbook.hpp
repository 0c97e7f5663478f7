#pragma once
// Leapfrog with fractional contact as a textbook would write it, without SIMD, folding or static forces taken out:
// something to hold the kernels against. Written from the model's equations; takes only constants from Chain.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/model/chain.hpp"

namespace hertzline::test {

class Textbook {
public:
    Textbook(const Scene& scene, double step_s)
        : chain_(scene), drive_(scene.drive), h_(step_s), x(size()), v(size()), force_(size() + 1) {}

    void step() {
        const double middle = (static_cast<double>(steps_) + 0.5) * h_;
        auto [horn_x, horn_v] = horn(middle);
        if (std::abs(drive_.cycles / drive_.frequency_hz - middle) <
            h_ / 2) {  // the burst ends within the step
            horn_v = (horn(middle + h_ / 2).x - horn(middle - h_ / 2).x) / h_;
        }
        drift();
        contacts(v, horn_x, horn_v);
        std::vector<double> half = v;
        kick(half, h_ / 2);
        contacts(half, horn_x, horn_v);
        kick(v, h_);
        drift();
        ++steps_;
    }

private:
    std::size_t size() const { return static_cast<std::size_t>(chain_.bodies()); }

    struct Horn {
        double x, v;
    };
    /// A hann burst (docs/model.md, section 5).
    Horn horn(double t) const {
        const double duration = drive_.cycles / drive_.frequency_hz;
        if (t <= 0 || t >= duration) {
            return {0, 0};
        }
        const double carrier = 2 * std::numbers::pi * drive_.frequency_hz;
        const double slow = 2 * std::numbers::pi / duration;
        const double envelope = (1 - std::cos(slow * t)) / 2;
        return {drive_.amplitude_m * envelope * std::sin(carrier * t),
                drive_.amplitude_m * (slow * std::sin(slow * t) / 2 * std::sin(carrier * t) +
                                      envelope * carrier * std::cos(carrier * t))};
    }

    void drift() {
        for (std::size_t b = 0; b < size(); ++b) {
            x[b] += h_ / 2 * v[b];
        }
    }

    /// Contact forces f_c (docs/model.md, section 3), the dashpots weighed by the part of the step in contact.
    void contacts(const std::vector<double>& u, double horn_x, double horn_v) {
        for (std::size_t c = 0; c < size(); ++c) {
            const auto i = static_cast<Eigen::Index>(c);
            const double overlap = chain_.static_overlap[i] + (c > 0 ? x[c - 1] : horn_x) - x[c];
            const double w = (c > 0 ? u[c - 1] : horn_v) - u[c];
            const double way = std::abs(w) * h_;
            const double part = way > 0 ? std::clamp(0.5 + overlap / way, 0.0, 1.0) : 0;
            force_[c] =
                chain_.stiffness[i] * std::pow(std::max(overlap, 0.0), 1.5) + chain_.damping[i] * w * part;
            if (chain_.tension == Tension::clamped) {
                force_[c] = std::max(force_[c], 0.0);
            }
        }
        if (chain_.end.loaded == EndLoad::last_sphere) {
            force_[size() - 1] = chain_.preload_n;
        }
    }

    /// Equations of motion (docs/model.md, section 4).
    void kick(std::vector<double>& u, double time) const {
        for (std::size_t b = 0; b < size(); ++b) {
            const auto i = static_cast<Eigen::Index>(b);
            const bool is_end = b + 1 == size();
            const double from_right =
                !is_end ? force_[b + 1] : chain_.spring[i] * x[b] + chain_.preload_n - chain_.bias[i];
            u[b] = v[b] + time * chain_.inv_mass[i] * (force_[b] - from_right);
        }
    }

    Chain chain_;
    Drive drive_;
    double h_;
    long steps_ = 0;

public:
    std::vector<double> x, v;  ///< displacements [m] and velocities [m/s] of all bodies

private:
    std::vector<double> force_;  ///< of each contact [N]
};

}  // namespace hertzline::test
