#include "core/solvers/series_scales.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/model/damping.hpp"

namespace hertzline {

double velocity_scale(const Chain& chain, const Drive& drive, double omega) noexcept {
    const double horn = 2 * std::numbers::pi * drive.frequency_hz * drive.amplitude_m;
    const double kick = (chain.bias * chain.inv_mass).abs().maxCoeff() / omega;
    return std::max(horn, std::isfinite(kick) ? kick : 0);
}

double negligible_overlap(const Chain& chain, double tolerance, double step) noexcept {
    constexpr double share = 1e-3;
    const double stiffest = (chain.stiffness * chain.inv_mass).maxCoeff();
    double overlap = std::pow(share * tolerance / (stiffest * step), 2.0 / 3);
    if (chain.damping_law !=
        DampingLaw::dashpot) {  // whose force grows from zero, but faster than the elastic one
        const double power = damping_exponent(chain.damping_law) + 1;
        const double strongest = (chain.damping * chain.inv_mass).maxCoeff() / power;
        overlap = std::min(overlap, std::pow(share * tolerance / strongest, 1 / power));
    }
    return chain.preload_n > 0 ? std::min(overlap, 1e-6 * chain.static_overlap.minCoeff()) : overlap;
}

}  // namespace hertzline
