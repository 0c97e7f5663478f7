#include "measures/beam.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace hertzline::measures {

namespace {

/// The peaks along a line of points, in the order of output.points_m.
struct Beam {
    std::vector<double> place_m;  ///< along the line
    const std::vector<double>& peak_pa;
    std::size_t loudest;
};

Beam beam_of(const Run& run) {
    Beam beam{{}, run.peaks_p_points, 0};
    const auto& points = run.scene().output.points_m;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const double step = i == 0
                                ? 0
                                : std::hypot(points[i][0] - points[i - 1][0], points[i][1] - points[i - 1][1],
                                             points[i][2] - points[i - 1][2]);
        beam.place_m.push_back(step + (i == 0 ? 0 : beam.place_m.back()));
        beam.loudest = beam.peak_pa[i] > beam.peak_pa[beam.loudest] ? i : beam.loudest;
    }
    return beam;
}

/// Whether the points lie on a straight line, one after the other.
bool is_line(const std::vector<std::array<double, 3>>& points) {
    constexpr double straight = 1e-6;
    const auto way = [&points](std::size_t from, std::size_t to) {
        return std::hypot(points[to][0] - points[from][0], points[to][1] - points[from][1],
                          points[to][2] - points[from][2]);
    };
    double sum = 0;
    for (std::size_t i = 1; i < points.size(); ++i) {
        sum += way(i - 1, i);
    }
    return points.size() > 1 && sum <= way(0, points.size() - 1) * (1 + straight);
}

/// Where the peak has fallen by 6 dB, from the loudest point on in a direction; nothing where it has not at the line's end.
std::optional<double> edge_of_spot(const Beam& beam, std::ptrdiff_t direction) {
    const double level = 0.5011872336272722 * beam.peak_pa[beam.loudest];
    auto i = static_cast<std::ptrdiff_t>(beam.loudest);
    for (; i + direction >= 0 && i + direction < std::ssize(beam.peak_pa); i += direction) {
        const auto here = static_cast<std::size_t>(i);
        const auto next = static_cast<std::size_t>(i + direction);
        if (beam.peak_pa[next] <= level) {
            const double share = (beam.peak_pa[here] - level) / (beam.peak_pa[here] - beam.peak_pa[next]);
            return beam.place_m[here] + share * (beam.place_m[next] - beam.place_m[here]);
        }
    }
    return std::nullopt;
}

}  // namespace

std::optional<double> spot_width_m(const Run& run) {
    if (!is_line(run.scene().output.points_m)) {
        return std::nullopt;
    }
    const Beam beam = beam_of(run);
    const auto from = edge_of_spot(beam, -1);
    const auto to = edge_of_spot(beam, 1);
    return from && to ? std::optional(*to - *from) : std::nullopt;
}

std::optional<double> side_lobe_db(const Run& run) {
    if (!is_line(run.scene().output.points_m)) {
        return std::nullopt;
    }
    const Beam beam = beam_of(run);
    const std::vector<double>& p = beam.peak_pa;
    double largest = 0;
    for (const std::ptrdiff_t direction : {-1, 1}) {
        auto i = static_cast<std::ptrdiff_t>(beam.loudest);
        const auto at = [&p](std::ptrdiff_t place) { return p[static_cast<std::size_t>(place)]; };
        const auto inside = [&p](std::ptrdiff_t place) { return place >= 0 && place < std::ssize(p); };
        while (inside(i + direction) && at(i + direction) <= at(i)) {
            i += direction;
        }
        for (i += direction; inside(i); i += direction) {
            largest = std::max(largest, at(i));
        }
    }
    return largest > 0 ? std::optional(20 * std::log10(largest / p[beam.loudest])) : std::nullopt;
}

}  // namespace hertzline::measures
