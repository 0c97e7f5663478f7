#include "core/plate/disc_modes.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "core/plate/quadrature.hpp"

namespace hertzline {

namespace {

constexpr double pi = std::numbers::pi;

double i0(double x) noexcept {
    return std::cyl_bessel_i(0.0, x);
}
double i1(double x) noexcept {
    return std::cyl_bessel_i(1.0, x);
}

/// The point where the condition changes its sign, by halving.
template <class Condition>
double zero_between(double low, double high, Condition condition) noexcept {
    const bool rising = condition(high) > 0;
    for (;;) {
        const double middle = 0.5 * (low + high);
        if (middle <= low || middle >= high) {
            return middle;
        }
        ((condition(middle) > 0) == rising ? high : low) = middle;
    }
}

/// The root of a thin disc near (n + 1) pi, between a quarter of pi below and above.
double thin_root(int number) noexcept {
    const double low = (number + 0.75) * pi;
    return zero_between(low, low + 0.5 * pi, [](double l) { return ::j0(l) * i1(l) + ::j1(l) * i0(l); });
}

/// The waves of a thick disc at a frequency: squares of their numbers, the second one negative where it does not propagate.
struct Waves {
    double first, second;
    double stretch;  ///< S w^2: the square of a pure shear wave's number

    Waves(double frequency, const DiscShear& shear) noexcept {
        const double r = shear.rotary;
        const double s = shear.compliance;
        const double square = frequency * frequency;
        first = 0.5 * (square * (r + s) + std::sqrt(std::pow(square * (r - s), 2) + 4 * square));
        second = square * (r * s * square - 1) / first;  // the product of both is known
        stretch = s * square;
    }
};

/// J0(x) and J1(x)/x for a square of x that may be negative: entire functions of it.
struct OfSquare {
    double zero, first;

    explicit OfSquare(double square) noexcept {
        constexpr double least = 1e-150;
        const double x = std::max(std::sqrt(std::abs(square)), least);
        zero = square > 0 ? ::j0(x) : i0(x);
        first = (square > 0 ? ::j1(x) : i1(x)) / x;
    }
};

/// The squares of the frequencies of a disc whose rim is held but free to tilt, of both branches: J0 of one of its waves is 0 at the rim.
std::vector<double> tilting_squares(int count, const DiscShear& shear) {
    const double product = shear.rotary * shear.compliance;
    std::vector<double> squares;
    for (int n = 0; n < count; ++n) {
        const double low = (n + 0.5) * pi;
        const double k2 = std::pow(zero_between(low, low + 0.5 * pi, [](double x) { return ::j0(x); }), 2);
        const double b = k2 * (shear.rotary + shear.compliance) + 1;
        const double larger = 0.5 * (b + std::sqrt(std::max(b * b - 4 * product * k2 * k2, 0.0)));
        squares.push_back(k2 * k2 / larger);
        squares.push_back(larger / product);
    }
    std::sort(squares.begin(), squares.end());
    return squares;
}

/// The frequency of a thick disc's mode. Clamping a rim that may tilt is one constraint more, so exactly one frequency of the clamped disc
/// lies between two neighbours of the other (Rayleigh): none is missed, and none is found twice.
double thick_frequency(int number, const DiscShear& shear) {
    const std::vector<double> bounds = tilting_squares(number + 2, shear);
    const auto n = static_cast<std::size_t>(number);
    return zero_between(std::sqrt(bounds[n]), std::sqrt(bounds[n + 1]), [&shear](double frequency) {
        const Waves waves(frequency, shear);
        const OfSquare one(waves.first);
        const OfSquare other(waves.second);
        return (waves.stretch - waves.first) * one.first * other.zero -
               (waves.stretch - waves.second) * other.first * one.zero;
    });
}

/// int_0^1 J0(p r) J0(k r) r dr (Abramowitz and Stegun, 11.3.29).
double product_of_waves(double p, double j0_p, double j1_p, double k, double j0_k, double j1_k) noexcept {
    const double apart = p * p - k * k;
    constexpr double near = 1e-6;  // where the quotient would lose half its digits
    return std::abs(k - p) < near ? 0.5 * (j0_p * j0_p + j1_p * j1_p)
                                  : (p * j1_p * j0_k - k * j0_p * j1_k) / apart;
}

}  // namespace

DiscMode::DiscMode(int number, const DiscShear& shear) {
    if (shear.rotary == 0 && shear.compliance == 0) {
        root_ = second_ = thin_root(number);
    } else {
        const double frequency = thick_frequency(number, shear);
        const Waves waves(frequency, shear);
        constexpr double least = 1e-300;
        const double second = std::max(std::abs(waves.second), least);
        root_ = std::sqrt(waves.first);
        second_ = std::sqrt(second);
        propagates_ = waves.second > 0;
        slowing_ = frequency / waves.first;
        tilt_ = 1 - waves.stretch / waves.first;
        second_tilt_ = 1 - waves.stretch / (propagates_ ? second : -second);
    }
    j0_ = ::j0(root_);
    j1_ = ::j1(root_);
    c0_ = propagates_ ? ::j0(second_) : i0(second_);
    c1_ = propagates_ ? ::j1(second_) : i1(second_);
    ratio_ = c1_ / c0_;
    slope_ratio_ = (propagates_ ? -second_ : second_) / root_;
    // from phi(1) = 0, or from psi(1) = 0 where both waves are about 0 there
    share_ = std::abs(c0_) >= std::abs(c1_) || !propagates_
                 ? j0_ / c0_
                 : -tilt_ * j1_ / (second_tilt_ * slope_ratio_ * c1_);
    // phi^2, psi^2 and phi r are smooth: 32 nodes give all digits for every mode
    mass_ = 2 * integral<32>(0, 1, [this](double r) { return r * shape(r) * shape(r); });
    if (shear.rotary > 0) {
        mass_ +=
            2 * shear.rotary * integral<32>(0, 1, [this](double r) { return r * rotation(r) * rotation(r); });
    }
    mean_ = 2 * integral<32>(0, 1, [this](double r) { return r * shape(r); });
}

double DiscMode::shape(double r) const noexcept {
    const double second = propagates_ ? ::j0(second_ * r) : i0(second_ * r);
    return (::j0(root_ * r) - share_ * second) / (1 - share_);
}

double DiscMode::slope_over_r(double r) const noexcept {
    constexpr double near = 1e-8;  // where both Bessel functions are half their argument
    const double share = share_ * slope_ratio_;
    if (r < near) {
        return -0.5 * root_ * root_ * (1 + share * std::abs(slope_ratio_)) / (1 - share_);
    }
    const double second = propagates_ ? ::j1(second_ * r) : i1(second_ * r);
    return -root_ * (::j1(root_ * r) + share * second) / (r * (1 - share_));
}

double DiscMode::rotation(double r) const noexcept {
    const double second = propagates_ ? ::j1(second_ * r) : i1(second_ * r);
    return root_ * (tilt_ * ::j1(root_ * r) + second_tilt_ * share_ * slope_ratio_ * second) / (1 - share_);
}

double DiscMode::transform(double k, double j0_k, double j1_k) const noexcept {
    const double first = product_of_waves(root_, j0_, j1_, k, j0_k, j1_k);
    const double second = propagates_
                              ? share_ * product_of_waves(second_, c0_, c1_, k, j0_k, j1_k)
                              : j0_ * (second_ * ratio_ * j0_k + k * j1_k) / (second_ * second_ + k * k);
    return (first - second) / (1 - share_);
}

std::vector<DiscMode> disc_modes(int count, const DiscShear& shear) {
    std::vector<DiscMode> modes;
    modes.reserve(static_cast<std::size_t>(count));
    for (int n = 0; n < count; ++n) {
        modes.emplace_back(n, shear);
    }
    return modes;
}

}  // namespace hertzline
