#pragma once
// The spot of a beam, by the peak pressures at output.points_m, where these lie on a straight line, in its order (docs/measures.md).

#include <optional>

#include "hertzline/run.hpp"

namespace hertzline::measures {

/// Width at -6 dB of the largest peak [m]; nothing where the peaks do not fall as far on both sides, or the points are no line. @param run with points
std::optional<double> spot_width_m(const Run& run);

/// The largest peak beyond the first minima on both sides, over that of the spot [dB]; nothing where there is no minimum, or the points are no line.
/// @param run with points
std::optional<double> side_lobe_db(const Run& run);

}  // namespace hertzline::measures
