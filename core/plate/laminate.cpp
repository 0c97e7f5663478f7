#include "core/plate/laminate.hpp"

#include <array>
#include <cmath>

namespace hertzline {

namespace {

/// Calls visit(layer, from, to) with the layers' faces, measured from `origin`.
template <class Visit>
void each_layer(std::span<const Layer> layers, double origin, const Visit& visit) {
    double from = -origin;
    for (const Layer& layer : layers) {
        visit(layer, from, from + layer.thickness_m);
        from += layer.thickness_m;
    }
}

/// The integral of s^2 over a layer.
double second_moment(double from, double to) noexcept {
    const double h = to - from;
    const double centre = (from + to) / 2;
    return h * (h * h / 12 + centre * centre);
}

double neutral_plane(std::span<const Layer> layers) noexcept {
    double stretch = 0;   // A
    double coupling = 0;  // B
    each_layer(layers, 0, [&](const Layer& layer, double from, double to) {
        stretch += plane_strain_modulus(layer.solid) * layer.thickness_m;
        coupling += plane_strain_modulus(layer.solid) * layer.thickness_m * (from + to) / 2;
    });
    return coupling / stretch;
}

/// The integral of g^2/G over the section, where g(s) is that of Q y dy from the first face to s: the shear stress over its force,
/// times D. Exact, since g^2 is of degree 4 in a layer.
double shear_compliance(std::span<const Layer> layers, double origin) noexcept {
    constexpr double node = 0.7745966692414834;  // sqrt(3/5), of Gauss's rule with three points
    constexpr std::array<double, 3> nodes{-node, 0, node};
    constexpr std::array<double, 3> weights{5.0 / 18, 8.0 / 18, 5.0 / 18};
    double flow = 0;
    double compliance = 0;
    each_layer(layers, origin, [&](const Layer& layer, double from, double to) {
        const double q = plane_strain_modulus(layer.solid);
        for (std::size_t i = 0; i < nodes.size(); ++i) {
            const double s = (from + to) / 2 + nodes[i] * (to - from) / 2;
            const double g = flow + q * (s - from) * (s + from) / 2;
            compliance += weights[i] * (to - from) * g * g / shear_modulus(layer.solid);
        }
        flow += q * (to - from) * (to + from) / 2;
    });
    return compliance;
}

}  // namespace

Laminate laminate(std::span<const Layer> layers) noexcept {
    if (layers.size() == 1) {
        const Layer& layer = layers.front();
        return {.section = plate_section(layer.solid, layer.thickness_m, layer.loss_factor),
                .neutral_plane_m = layer.thickness_m / 2};
    }
    const double origin = neutral_plane(layers);
    PlateSection section{.shear_n_per_m = 0};
    double lost = 0;
    double alike = 0;
    each_layer(layers, origin, [&](const Layer& layer, double from, double to) {
        const double bending = plane_strain_modulus(layer.solid) * second_moment(from, to);
        section.thickness_m += layer.thickness_m;
        section.bending_n_m += bending;
        section.mass_kg_per_m2 += layer.solid.density_kg_per_m3 * layer.thickness_m;
        section.rotary_kg += layer.solid.density_kg_per_m3 * second_moment(from, to);
        lost += layer.loss_factor * bending;
        alike += plate_section(layer.solid, layer.thickness_m, 0).shear_n_per_m;
    });
    section.loss_factor = lost / section.bending_n_m;
    section.shear_n_per_m = section.bending_n_m * section.bending_n_m / shear_compliance(layers, origin);
    return {.section = section, .neutral_plane_m = origin, .shear_ratio = section.shear_n_per_m / alike};
}

}  // namespace hertzline
