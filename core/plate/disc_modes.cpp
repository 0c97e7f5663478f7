#include "core/plate/disc_modes.hpp"

#include <cmath>
#include <numbers>

#include "core/plate/quadrature.hpp"

namespace hertzline {

namespace {

double i0(double x) noexcept {
    return std::cyl_bessel_i(0.0, x);
}
double i1(double x) noexcept {
    return std::cyl_bessel_i(1.0, x);
}

/// The root near (n + 1) pi, between a quarter of pi below and above, by halving.
double root_of(int number) noexcept {
    const auto condition = [](double l) { return ::j0(l) * i1(l) + ::j1(l) * i0(l); };
    double low = (number + 0.75) * std::numbers::pi;
    double high = low + 0.5 * std::numbers::pi;
    const bool rising = condition(high) > 0;
    for (;;) {
        const double middle = 0.5 * (low + high);
        if (middle <= low || middle >= high) {
            return middle;
        }
        ((condition(middle) > 0) == rising ? high : low) = middle;
    }
}

}  // namespace

DiscMode::DiscMode(int number)
    : root_(root_of(number)),
      j0_(::j0(root_)),
      j1_(::j1(root_)),
      i_ratio_(i1(root_) / i0(root_)),
      share_(j0_ / i0(root_)) {
    // phi^2 r and phi r are smooth: 32 nodes give all digits for every mode
    mass_ = 2 * integral<32>(0, 1, [this](double r) { return r * shape(r) * shape(r); });
    mean_ = 2 * integral<32>(0, 1, [this](double r) { return r * shape(r); });
}

double DiscMode::shape(double r) const noexcept {
    return (::j0(root_ * r) - share_ * i0(root_ * r)) / (1 - share_);
}

double DiscMode::slope_over_r(double r) const noexcept {
    constexpr double near = 1e-8;  // where both Bessel functions are half their argument
    if (r < near) {
        return -0.5 * root_ * root_ * (1 + share_) / (1 - share_);
    }
    return -root_ * (::j1(root_ * r) + share_ * i1(root_ * r)) / (r * (1 - share_));
}

/// Lommel's integrals of J0 J0 and of I0 J0 (Abramowitz and Stegun, 11.3.29).
double DiscMode::transform(double k, double j0_k, double j1_k) const noexcept {
    const double apart = root_ * root_ - k * k;
    constexpr double near = 1e-6;  // where the quotient would lose half its digits
    const double with_j = std::abs(k - root_) < near ? 0.5 * (j0_ * j0_ + j1_ * j1_)
                                                     : (root_ * j1_ * j0_k - k * j0_ * j1_k) / apart;
    const double with_i = j0_ * (root_ * i_ratio_ * j0_k + k * j1_k) / (root_ * root_ + k * k);
    return (with_j - with_i) / (1 - share_);
}

}  // namespace hertzline
