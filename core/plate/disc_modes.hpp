#pragma once
// The axisymmetric vibrations of a thin disc that is clamped at its rim, in numbers without units (A. W. Leissa, Vibration of Plates,
// NASA SP-160, 1969, section 2.1.1): lengths in units of the disc's radius.

namespace hertzline {

inline constexpr int max_disc_modes = 6;

/// One shape: phi(r) = [J0(l r) - (J0(l)/I0(l)) I0(l r)] / [1 - J0(l)/I0(l)], 1 at the centre.
class DiscMode {
public:
    /// @param number from 0 to max_disc_modes - 1
    explicit DiscMode(int number);

    /// The root l of J0(l) I1(l) + J1(l) I0(l) = 0: the bending wave's number times the radius.
    double root() const noexcept { return root_; }
    /// Modal mass over the disc's: 2 int phi^2 r dr.
    double mass() const noexcept { return mass_; }
    /// Mean of phi over the disc: 2 int phi r dr.
    double mean() const noexcept { return mean_; }

    /// phi at 0 <= r <= 1.
    double shape(double r) const noexcept;
    /// phi'(r)/r at 0 <= r <= 1.
    double slope_over_r(double r) const noexcept;
    /// int_0^1 phi(r) J0(k r) r dr. @param j0_k, j1_k J0 and J1 of k, which modes share
    double transform(double k, double j0_k, double j1_k) const noexcept;

private:
    double root_;
    double j0_, j1_;  // of the root
    double i_ratio_;  // I1/I0 of the root
    double share_;    // J0/I0 of the root
    double mass_ = 0;
    double mean_ = 0;
};

}  // namespace hertzline
