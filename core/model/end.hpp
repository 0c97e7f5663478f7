#pragma once
// The end that the last sphere presses against: a linear system that the force of the last contact drives.

#include <memory>
#include <vector>

#include "core/plate/laminate.hpp"
#include "core/plate/plate_response.hpp"
#include "hertzline/scene.hpp"

namespace hertzline {

/// A body with one degree of freedom: q'' = inv_mass (f - spring q), where f is the force of the last contact [N].
struct EndMode {
    double inv_mass = 0;  ///< [1/kg]
    double spring = 0;    ///< stiffness to ground [N/m]
};

/// The body on which the static force of the end does work: a load that holds it, or, unbalanced, one that the end yields to from the start.
enum class EndLoad { none, last_sphere, end, unbalanced };

/// All that an end is to the rest of the program. A wall does not move, and the paper's plate is one mass on one spring. A modal plate
/// has many states: to the chain it is a body with the mobility that the plate has at once, and the rest of its states' effect is a
/// force behind that body (integrators/plate_motion.hpp).
struct EndModel {
    double contact_stiffness = 0;  ///< k of the last contact [N/m^(3/2)]; 0: nothing to touch
    EndMode body;                  ///< the end as the chain's last body
    EndLoad loaded = EndLoad::none;
    bool has_plate = false;                      ///< the paper's: whether the end's velocity is an output
    std::shared_ptr<const PlateResponse> plate;  ///< of a modal plate; else null
    /// sqrt(T_m T_w): part of the last sphere's velocity that goes into the medium directly
    double transmission = 1;

    /// v_out, the velocity transmitted into the medium [m/s] (docs/model.md, section 6).
    /// @param closed whether the last contact touches
    double output_velocity(double v_last, double v_end, bool closed) const noexcept {
        return has_plate ? (closed ? transmission * v_last : 0) + v_end : v_last;
    }
};

/// The layers of the disc from the sphere to the medium; one where the scene gives no lists of them.
std::vector<Layer> layers_of(const Scene& scene);

/// The material that the last sphere touches: of the wall, or of the disc's first layer.
const std::string& touched_material(const Scene& scene) noexcept;

/// Mass [kg] of the whole disc, rho pi a^2 h of each layer. Clamped at its rim, it moves as a quarter of that would
/// (docs/model.md, section 4).
double plate_mass(const Scene& scene);

/// Stiffness [N/m] of a clamped disc under a central load, by the theory of thin plates unless the scene gives its own.
double plate_stiffness(const Scene& scene);

/// Power transmission from impedance a into b: 1 - ((Zb - Za)/(Zb + Za))^2.
double transmission(double impedance_a, double impedance_b) noexcept;

/// sqrt(T_m T_w): amplitude factor from the last sphere through the disc into the medium (docs/model.md, section 6). Of a disc with
/// layers the root of the product of all T between neighbours.
double output_transmission(const Scene& scene);

/// The end of a scene that has passed validate().
EndModel end_model(const Scene& scene);

/// Frequency of a sphere between two contacts that are pressed as far as the drive can, or as the preload does [Hz]: the highest
/// that a chain passes on.
double fastest_contact_hz(const Scene& scene);

/// The parameters that the response of the scene's plate depends on, up to five times the frequency of its fastest contacts in motion.
PlateParameters plate_parameters(const Scene& scene);

/// Why a plate cannot be computed: its layers do not bend as one; or, of a modal plate, the disc is too large for the sound's waves, or
/// too fast for the chain.
std::vector<Fault> plate_faults(const Scene& scene);

/// Why the response of a modal plate cannot be used: its poles do not fit it. Takes as long as the fit.
std::vector<Fault> response_faults(const Scene& scene);

/// The poles of the scene's modal plate: numerics.poles, or as many as the accuracy asks for. 0: its plate is not modal.
int plate_poles(const Scene& scene);

}  // namespace hertzline
