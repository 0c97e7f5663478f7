#include "core/model/chain.hpp"

#include <numbers>

#include "core/model/hertz.hpp"

namespace hertzline {

namespace {

const Solid& solid(const Scene& scene, const std::string& name) {
    return std::get<Solid>(*find_material(scene, name));
}

double sphere_mass(const Solid& material, double radius_m) {
    return material.density_kg_per_m3 * 4 / 3 * std::numbers::pi * radius_m * radius_m * radius_m;
}

}  // namespace

Chain::Chain(const Scene& scene)
    : end(end_model(scene)),
      // without dashpots nothing pulls: then there is nothing to clamp, and no grazing force to decide about
      tension(scene.chain.damping_kg_per_s > 0 ? scene.chain.tension : Tension::allowed),
      preload_n(scene.chain.preload_n) {
    const Eigen::Index n = scene.chain.spheres;
    const double radius = scene.chain.diameter_m / 2;
    const Solid& sphere = solid(scene, scene.chain.material);
    const Solid& horn = solid(scene, scene.drive.material);

    stiffness.setConstant(n + 1, sphere_sphere_stiffness(sphere, radius));
    stiffness[0] = flat_sphere_stiffness(horn, sphere, radius);
    stiffness[n] = end.contact_stiffness;
    damping.setConstant(n + 1, scene.chain.damping_kg_per_s);
    damping[n] = end.contact_damping;
    inv_mass.setConstant(n + 1, 1 / sphere_mass(sphere, radius));
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
