#include "core/integrators/series_piece.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/model/contact_law.hpp"

namespace hertzline::kernels {

HornWaves::HornWaves(const std::array<double, 3>& frequency_hz, double unit_s) {
    constexpr double fastest = 0.8;  // radians a unit: the rest of the series is below rounding
    for (std::size_t i = 0; i < frequency_hz.size(); ++i) {
        const double step = 2 * std::numbers::pi * frequency_hz[i] * unit_s;
        turns = turns && std::abs(step) <= fastest;
        reach_of_each[i] = fastest / std::abs(step);
        double term = 1;
        for (std::size_t n = 0; n < 2 * pairs; ++n) {
            const double sign = n % 4 < 2 ? 1 : -1;
            (n % 2 == 0 ? even : odd)[i][n / 2] = sign * term;
            (n % 2 == 0 ? even_by_pair : odd_by_pair)[n / 2][i] = sign * term;
            term *= step / static_cast<double>(n + 1);
        }
    }
}

HornMotion SeriesPiece::tip_motion(const HornTip::Terms& terms, double z) const noexcept {
    double x = 0;
    double slope = 0;
    for (std::size_t n = terms.size(); n-- > 0;) {
        slope = slope * z + x;
        x = x * z + terms[n];
    }
    if (onset) {
        const std::span<const OnsetForce> forces = onset_forces();
        for (std::size_t f = 0; f < forces.size(); ++f) {
            double power = forces[f].integrated_power(z);
            for (int n = 0; n < onset_terms; ++n, power *= z) {
                const double once = n + (forces[f].exponent + 1);
                const double term = tip->onset[f][static_cast<std::size_t>(n)] * power / once;
                slope += term;
                x += term * z / (once + 1);
            }
        }
    }
    return {.x = x, .v = slope * per_unit, .a = 0};
}

void SeriesPiece::reset_motion() noexcept {
    std::fill_n(terms_.get(), slots_ * static_cast<std::size_t>(degree_ + 1), 0.0);
    onset = false;
    largest = 0;
    length = 0;
}

SeriesPiece::SeriesPiece(std::size_t slots, int degree, const HornWaves& horn_waves, DampingLaw law)
    : waves(horn_waves), slots_((slots + 7) / 8 * 8), degree_(degree), law_(law) {
    terms_ = aligned_zeros(slots_ * static_cast<std::size_t>(rows(degree, law)));
    onset_forces_[0] = OnsetForce{1.5, onset_force(0, 0), slots_};
    if (law != DampingLaw::dashpot) {
        onset_forces_[1] = OnsetForce{damping_exponent(law), onset_force(1, 0), slots_};
    }
}

}  // namespace hertzline::kernels
