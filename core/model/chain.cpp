#include "core/model/chain.hpp"

#include <algorithm>
#include <cmath>

#include "core/model/contact_law.hpp"
#include "core/model/drive.hpp"
#include "core/model/sphere_row.hpp"
#include "core/scene/elements.hpp"
#include "core/scene/scene_key.hpp"
#include "core/scene/text.hpp"

namespace hertzline {

Chain::Chain(const Scene& scene)
    : end(end_model(scene)),
      damping_law(scene.chain.damping_law),
      // without damping nothing pulls: then there is nothing to clamp, and no grazing force to decide about
      tension(damping_factor(scene.chain, 1, 1) > 0 ? scene.chain.tension : Tension::allowed),
      preload_n(drawn_preload_n(scene)),
      holder_rate(scene.chain.holder_time_s ? 1 / *scene.chain.holder_time_s : 0),
      impact_velocity(scene.chain.impact_velocity_m_per_s),
      impact_spheres(impact_velocity != 0 ? scene.chain.impact_spheres : 0) {
    if (const auto resonator = horn_resonator(scene.drive)) {
        horn_inv_mass = resonator->inv_mass;
        horn_square = resonator->square;
    }
    const SphereRow row(scene);
    const Eigen::Index n = row.size();
    for (Eigen::ArrayXd* column : {&stiffness, &static_overlap, &static_force, &damping, &radius, &inv_mass,
                                   &spring, &drag, &bias, &load}) {
        column->setZero(n + 1);
    }
    double force = preload_n;
    double horn_force = 0;
    const auto press = [&](Eigen::Index contact, double k, double mass) {
        stiffness[contact] = k;
        damping[contact] = damping_factor(scene.chain, k, mass);
        static_overlap[contact] = k > 0 ? hertzline::static_overlap(k, force) : 1.0;
        static_force[contact] = elastic_force(k, static_overlap[contact]);
    };
    Sphere before;
    for (Eigen::Index i = 0; i < n; ++i) {
        const Sphere sphere = row[i];
        if (i > 0) {
            press(i, contact_stiffness(before, sphere), reduced_mass(before, sphere));
        } else if (scene.drive.kind == DriveKind::none) {
            press(0, 0, 0);
            horn_force = force;
        } else {  // horn and end count as immovable
            press(
                0,
                flat_sphere_stiffness(solid_of(scene, scene.drive.material), *sphere.solid, sphere.radius_m),
                sphere.mass_kg);
        }
        radius[i] = sphere.radius_m;
        inv_mass[i] = 1 / sphere.mass_kg;
        drag[i] = sphere.mass_kg * holder_rate;
        load[i] = sphere.mass_kg * scene.chain.gravity_m_per_s2;
        force += load[i];
        before = sphere;
    }
    press(n, end.contact_stiffness, before.mass_kg);
    load[0] += horn_force;
    inv_mass[n] = end.body.inv_mass;
    spring[n] = end.body.spring;
    end_force_n = force;
    switch (end.loaded) {
        case EndLoad::none:
            break;
        case EndLoad::last_sphere:
            load[n - 1] -= force;
            break;
        case EndLoad::end:
            load[n] = -force;
            break;
        case EndLoad::unbalanced:
            bias[n] = force;
            break;
    }
}

std::vector<Fault> chain_faults(const Scene& scene) {
    const SphereRow row(scene);
    std::vector<Fault> faults;
    double smallest = 1;
    double largest = 0;
    const double preload_n = drawn_preload_n(scene);
    double force = preload_n;
    double least_force = force;
    const double gravity = scene.chain.gravity_m_per_s2;
    const Eigen::Index spheres = gravity < 0 ? row.size() : row.distinct();
    for (Eigen::Index i = 0; i < spheres; ++i) {
        const Sphere sphere = row[i];
        smallest = std::min(smallest, 2 * sphere.radius_m);
        largest = std::max(largest, 2 * sphere.radius_m);
        force += sphere.mass_kg * gravity;
        least_force = std::min(least_force, force);
    }
    const Range allowed = scene_key_named(scene, "chain.diameter_m")->range;
    if (scene.chain.taper != 0 && !(smallest >= allowed.min && largest <= allowed.max)) {
        faults.push_back(
            {"chain.taper",
             number_text(scene.chain.taper) + ", with spheres of " +
                 number_text(smallest >= allowed.min ? largest : smallest) + " m",
             "spheres of " + number_text(allowed.min) + " to " + number_text(allowed.max) + " m"});
    } else if (!(least_force >= 0)) {
        faults.push_back({"chain.gravity_m_per_s2",
                          number_text(gravity) + ", a weight of " + number_text(preload_n - least_force) +
                              " N away from the end",
                          "a weight of at most the preload of " + number_text(preload_n) +
                              " N: more pulls contacts apart at rest"});
    }
    return faults;
}

std::vector<Fault> model_faults(const Scene& scene) {
    std::vector<Fault> faults = drive_faults(scene.drive);
    if (faults.empty()) {
        faults = chain_faults(scene);
    }
    return faults.empty() ? plate_faults(scene) : faults;
}

}  // namespace hertzline
