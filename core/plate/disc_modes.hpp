#pragma once
// The axisymmetric vibrations of a disc that is clamped at its rim, in numbers without units: lengths in units of the disc's radius a,
// angular frequencies in units of sqrt(D/m)/a^2. Thin discs are those of Kirchhoff (A. W. Leissa, Vibration of Plates, NASA SP-160, 1969,
// section 2.1.1). Thick ones shear and have rotary inertia (R. D. Mindlin, J. Appl. Mech. 18 (1951) 31; H. Deresiewicz and R. D. Mindlin,
// J. Appl. Mech. 22 (1955) 86; docs/model.md, section 10).

#include <vector>

namespace hertzline {

inline constexpr int max_disc_modes = 6;

/// The difference between a thick disc and a thin one, which has neither.
struct DiscShear {
    double rotary = 0;      ///< R = J/(m a^2), rotary inertia
    double compliance = 0;  ///< S = D/(S_h a^2), of the shear
};

/// One shape: phi(r) = [J0(d1 r) - g C(d2 r)] / (1 - g), 1 at the centre, 0 at the rim. Both waves have the mode's frequency. C is I0, or
/// J0 where the second wave propagates: above the frequency sqrt(S_h/J) of a thick disc.
class DiscMode {
public:
    /// @param number from 0 to max_disc_modes - 1, in the order of the frequencies
    explicit DiscMode(int number, const DiscShear& shear = {});

    /// d1: the bending wave's number times the radius.
    double root() const noexcept { return root_; }
    /// Frequency over that of a thin disc's bending wave of the same length, d1^2.
    double slowing() const noexcept { return slowing_; }
    /// Modal mass over the disc's: 2 int (phi^2 + R psi^2) r dr.
    double mass() const noexcept { return mass_; }
    /// Mean of phi over the disc: 2 int phi r dr.
    double mean() const noexcept { return mean_; }

    /// phi at 0 <= r <= 1.
    double shape(double r) const noexcept;
    /// phi'(r)/r at 0 <= r <= 1.
    double slope_over_r(double r) const noexcept;
    /// psi at 0 <= r <= 1: rotation of the cross-section, -phi' in a thin disc.
    double rotation(double r) const noexcept;
    /// int_0^1 phi(r) J0(k r) r dr. @param j0_k, j1_k J0 and J1 of k, which modes share
    double transform(double k, double j0_k, double j1_k) const noexcept;

private:
    double root_;
    double second_;            // size of d2
    bool propagates_ = false;  // the second wave
    double slowing_ = 1;
    double tilt_ = 1;         // of the cross-section over the slope, in the first wave
    double second_tilt_ = 1;  // and in the second
    double j0_, j1_;          // of the root
    double c0_, c1_, ratio_;  // I0 and I1, or J0 and J1, of the second, and their ratio
    double share_;            // g
    double slope_ratio_;      // second wave's number over the first, negative where it propagates
    double mass_ = 0;
    double mean_ = 0;
};

/// The first modes.
std::vector<DiscMode> disc_modes(int count, const DiscShear& shear = {});

}  // namespace hertzline
