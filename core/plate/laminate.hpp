#pragma once
// A disc of layers that are bonded perfectly: the section in which it bends as one plate (classical lamination theory; J. N. Reddy,
// Mechanics of Laminated Composite Plates and Shells; docs/model.md, section 4).

#include <span>

#include "core/plate/plate_section.hpp"
#include "hertzline/materials.hpp"

namespace hertzline {

struct Layer {
    Solid solid{};
    double thickness_m = 0;
    double loss_factor = 0;
};

struct Laminate {
    PlateSection section;
    double neutral_plane_m = 0;  ///< where bending strains nothing, from the first layer's outer face
    /// Shear stiffness over that of layers that shear alike, 5/6 of the sum of G h: 1 of a single layer, small of a soft layer between
    /// stiff ones, which then bend each on its own.
    double shear_ratio = 1;
};

/// The laminate of at least one layer. One layer has the bits of plate_section().
Laminate laminate(std::span<const Layer> layers) noexcept;

}  // namespace hertzline
