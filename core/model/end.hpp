#pragma once
// What the last sphere leans on: a linear system that the force of the last contact drives.

#include <vector>

#include "core/scene/scene.hpp"

namespace hertzline {

/// One degree of freedom of an end: q'' = inv_mass (f - spring q + load), where f is the force of the last contact [N].
struct EndMode {
    double inv_mass = 0;  ///< [1/kg]
    double spring = 0;    ///< stiffness to ground [N/m]
    double load = 0;      ///< constant force that the static state leaves unbalanced [N]
};

/// The body on which the static preload does work, see energy.hpp.
enum class EndLoad { none, last_sphere, end };

/// All that an end is to the rest of the program. A wall has no modes; the paper's plate has one. The chain carries the first mode
/// as its last body (chain.hpp): integrators for ends with more of them must carry the others.
struct EndModel {
    double contact_stiffness = 0;  ///< k of the last contact [N/m^(3/2)]; 0: nothing to touch
    double contact_damping = 0;    ///< lambda of the last contact [kg/s]
    std::vector<EndMode> modes;    ///< the end's displacement is their sum
    EndLoad loaded = EndLoad::none;
    bool has_plate = false;  ///< whether the end's velocity is an output
    /// sqrt(T_m T_w): part of the last sphere's velocity that goes into the medium directly
    double transmission = 1;

    /// v_out, the velocity transmitted into the medium [m/s] (docs/model.md, section 6).
    /// @param closed whether the last contact touches
    double output_velocity(double v_last, double v_end, bool closed) const noexcept {
        return has_plate ? (closed ? transmission * v_last : 0) + v_end : v_last;
    }
};

/// The end of a scene that has passed validate().
EndModel end_model(const Scene& scene);

}  // namespace hertzline
