#include "core/plate/point_sound.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/plate/chebyshev.hpp"
#include "core/plate/quadrature.hpp"

namespace hertzline {

namespace {

constexpr std::size_t nodes_of_arc = 32;
constexpr std::size_t nodes_of_panel = 24;
constexpr double phase_per_panel = 8;  // phase that a panel of nodes covers

}  // namespace

ShapeTable::ShapeTable(const std::vector<DiscMode>& modes) : modes_(static_cast<Eigen::Index>(modes.size())) {
    constexpr int degrees = 40;  // the highest mode has 19 radians from centre to rim
    const auto angle = [](int i) { return std::numbers::pi * (i + 0.5) / degrees; };
    coefficients_.setZero(Shapes::SizeAtCompileTime, degrees);
    for (int i = 0; i < degrees; ++i) {
        const double r = std::sqrt(0.5 * (1 + std::cos(angle(i))));
        for (std::size_t n = 0; n < modes.size(); ++n) {
            const double shape = modes[n].shape(r);
            for (int q = 0; q < degrees; ++q) {
                coefficients_(static_cast<Eigen::Index>(n), q) +=
                    (q == 0 ? 1.0 : 2.0) / degrees * shape * std::cos(q * angle(i));
            }
        }
    }
}

ShapeTable::Shapes ShapeTable::operator()(double square) const {
    const Shapes zero = Shapes::Zero();
    return clenshaw(coefficients_.cols(), 2 * square - 1, zero,
                    [this](Eigen::Index q) { return coefficients_.col(q); });
}

PointSound::PointSound(const ShapeTable& shapes, double from_axis, double from_plane, double delay)
    : shapes_(shapes), from_axis_(from_axis), from_plane_(from_plane), delay_(delay) {
    const double s = from_axis;
    // the first sound, the moment from which the circle leaves the disc, and the last sound
    for (const double way : {std::max(0.0, s - 1), std::abs(1 - s), 1 + s}) {
        const double time = delay + std::hypot(way, from_plane);
        if (breaks_.empty() || time > breaks_.back()) {
            breaks_.push_back(time);
        }
    }
}

Eigen::ArrayXd PointSound::operator()(double time) const {
    const ShapeTable& shapes = shapes_;
    const double s = from_axis_;
    const double way = time - delay_;
    const double square = std::max(0.0, (way - from_plane_) * (way + from_plane_));
    const double u = std::sqrt(square);  // radius of the circle
    if (s == 0) {
        return shapes(std::min(square, 1.0)).head(shapes.modes());
    }
    const double end =
        u <= 1 - s ? std::numbers::pi : std::acos(std::clamp((s * s + square - 1) / (2 * s * u), -1.0, 1.0));
    const auto at = [&](double angle) {
        const double half = std::sin(0.5 * angle);
        return std::min(1.0, (s - u) * (s - u) + 4 * s * u * half * half);
    };
    ShapeTable::Shapes sum = ShapeTable::Shapes::Zero();
    each_node<nodes_of_arc>(
        0, end, [&](double angle, double weight) { sum += weight / std::numbers::pi * shapes(at(angle)); });
    return sum.head(shapes.modes());
}

SoundSum::SoundSum(std::vector<PointSound> sounds) : sounds_(std::move(sounds)) {
    for (const PointSound& sound : sounds_) {
        breaks_.insert(breaks_.end(), sound.breaks().begin(), sound.breaks().end());
    }
    std::sort(breaks_.begin(), breaks_.end());
    // discs at one distance, or with one sound at a focus, differ by the rounding of their times
    const double rounding = 1e-12 * breaks_.back();
    const auto same = [rounding](double a, double b) { return b - a <= rounding; };
    breaks_.erase(std::unique(breaks_.begin(), breaks_.end(), same), breaks_.end());
}

Eigen::ArrayXd SoundSum::operator()(double time) const {
    Eigen::ArrayXd sum = Eigen::ArrayXd::Zero(sounds_.front().modes());
    for (const PointSound& sound : sounds_) {
        if (time >= sound.first() && time <= sound.last()) {
            sum += sound(time);
        }
    }
    return sum;
}

std::vector<SoundSum> grouped(std::vector<PointSound> sounds) {
    constexpr double closely = 1;
    std::ranges::stable_sort(sounds, {}, &PointSound::first);
    std::vector<SoundSum> groups;
    std::vector<PointSound> open;
    double end = 0;
    for (const PointSound& sound : sounds) {
        if (!open.empty() && sound.first() > end + closely) {
            groups.emplace_back(std::exchange(open, {}));
        }
        end = std::max(end, sound.last());
        open.push_back(sound);
    }
    if (!open.empty()) {
        groups.emplace_back(std::move(open));
    }
    return groups;
}

PointSpectrum::PointSpectrum(const PointSound& sound, double max_ka) {
    const std::vector<double>& breaks = sound.breaks();
    std::vector<Eigen::ArrayXd> values;
    for (std::size_t b = 0; b + 1 < breaks.size(); ++b) {
        const double span = breaks[b + 1] - breaks[b];
        const int panels = 2 + static_cast<int>(max_ka * span / phase_per_panel);
        for (int panel = 0; panel < panels; ++panel) {
            each_node<nodes_of_panel>(
                static_cast<double>(panel) / panels, (panel + 1.0) / panels, [&](double x, double weight) {
                    const SmoothStep step = smooth_step(x);
                    times_.push_back(breaks[b] - breaks[0] + span * step.value);
                    values.emplace_back(weight * span * step.slope * sound(breaks[b] + span * step.value));
                });
        }
    }
    values_.resize(values.front().size(), static_cast<Eigen::Index>(values.size()));
    for (std::size_t i = 0; i < values.size(); ++i) {
        values_.col(static_cast<Eigen::Index>(i)) = values[i];
    }
}

Eigen::VectorXcd PointSpectrum::operator()(double ka) const {
    Eigen::VectorXcd waves(static_cast<Eigen::Index>(times_.size()));
    for (std::size_t i = 0; i < times_.size(); ++i) {
        waves[static_cast<Eigen::Index>(i)] = std::polar(1.0, -ka * times_[i]);
    }
    return std::complex<double>(0, ka) * (values_ * waves);
}

}  // namespace hertzline
