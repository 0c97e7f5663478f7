#include "core/model/chain.hpp"

#include <numbers>

#include "core/model/contact_law.hpp"

namespace hertzline {

namespace {

double sphere_mass(const Solid& material, double radius_m) {
    return material.density_kg_per_m3 * 4 / 3 * std::numbers::pi * radius_m * radius_m * radius_m;
}

}  // namespace

Chain::Chain(const Scene& scene)
    : end(end_model(scene)),
      damping_law(scene.chain.damping_law),
      // without damping nothing pulls: then there is nothing to clamp, and no grazing force to decide about
      tension(damping_factor(scene.chain, 1, 1) > 0 ? scene.chain.tension : Tension::allowed),
      preload_n(scene.chain.preload_n) {
    const Eigen::Index n = scene.chain.spheres;
    const double radius = scene.chain.diameter_m / 2;
    const Solid& sphere = solid_of(scene, scene.chain.material);
    const Solid& horn = solid_of(scene, scene.drive.material);

    stiffness.setConstant(n + 1, sphere_sphere_stiffness(sphere, radius));
    stiffness[0] = flat_sphere_stiffness(horn, sphere, radius);
    stiffness[n] = end.contact_stiffness;
    const double mass = sphere_mass(sphere, radius);
    damping.setConstant(n + 1, damping_factor(scene.chain, stiffness[n > 1 ? 1 : 0], mass / 2));
    damping[0] = damping_factor(scene.chain, stiffness[0], mass);  // horn and end count as immovable
    damping[n] = damping_factor(scene.chain, stiffness[n], mass);
    inv_mass.setConstant(n + 1, 1 / mass);
    spring.setZero(n + 1);
    bias.setZero(n + 1);
    inv_mass[n] = end.body.inv_mass;
    spring[n] = end.body.spring;
    bias[n] = end.body.load;

    static_overlap = stiffness.unaryExpr(
        [this](double k) { return k > 0 ? hertzline::static_overlap(k, preload_n) : 1.0; });
    static_force = stiffness.binaryExpr(static_overlap,
                                        [](double k, double overlap) { return elastic_force(k, overlap); });
}

}  // namespace hertzline
