#include "core/model/end.hpp"

#include "core/model/coupling.hpp"
#include "core/model/hertz.hpp"

namespace hertzline {

namespace {

const Solid& solid(const Scene& scene, const std::string& name) {
    return std::get<Solid>(*find_material(scene, name));
}

/// Nothing: the preload is held by a constant force on the last sphere.
EndModel free_end() {
    EndModel end;
    end.loaded = EndLoad::last_sphere;
    return end;
}

/// A half-space that does not move as a whole.
EndModel wall(const Scene& scene) {
    EndModel end;
    end.contact_stiffness = flat_sphere_stiffness(
        solid(scene, scene.end.material), solid(scene, scene.chain.material), scene.chain.diameter_m / 2);
    end.contact_damping = scene.chain.damping_kg_per_s;
    return end;
}

/// The paper's plate: one spring, and a quarter of the disc's mass.
EndModel plate(const Scene& scene) {
    const Solid& disc = solid(scene, scene.end.material);
    EndModel end = wall(scene);
    EndMode mode{.inv_mass = 4 / plate_mass(disc, scene.end), .spring = plate_stiffness(disc, scene.end)};
    if (scene.end.preload == PlatePreload::as_printed) {
        mode.load = scene.chain.preload_n;
    } else {
        end.loaded = EndLoad::end;
    }
    end.modes = {mode};
    end.has_plate = true;
    end.transmission = output_transmission(scene);
    return end;
}

}  // namespace

EndModel end_model(const Scene& scene) {
    switch (scene.end.kind) {
        case EndKind::plate:
            return plate(scene);
        case EndKind::wall:
            return wall(scene);
        case EndKind::free:
            return free_end();
    }
    return {};
}

}  // namespace hertzline
