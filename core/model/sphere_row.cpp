#include "core/model/sphere_row.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "core/model/contact_law.hpp"
#include "core/scene/elements.hpp"

namespace hertzline {

SphereRow::SphereRow(const Scene& scene)
    : spheres_(scene.chain.spheres),
      diameters_m_(scene.chain.diameters_m),
      taper_(scene.chain.taper),
      drawn_(scene.chain.tolerance > 0 ? &scene : nullptr) {
    const Spheres& chain = scene.chain;
    if (chain.materials.empty()) {
        names_ = {&chain.material};
    }
    for (const std::string& name : chain.materials) {
        names_.push_back(&name);
    }
    for (const std::string* name : names_) {
        solids_.push_back(&solid_of(scene, *name));
    }
    if (diameters_m_.empty()) {
        diameters_m_ = {chain.diameter_m};
    }
}

Sphere SphereRow::operator[](Eigen::Index number) const noexcept {
    const Solid& solid = *solids_[of(number, solids_)];
    const double scale = taper_ == 0 ? 1 : std::pow(1 - taper_, static_cast<double>(number));
    const double by_chance = drawn_ != nullptr ? 1 + drawn_->chain.tolerance * drawn(*drawn_, number) : 1;
    const double radius = diameters_m_[of(number, diameters_m_)] * scale * by_chance / 2;
    return {&solid, radius, solid.density_kg_per_m3 * 4 / 3 * std::numbers::pi * radius * radius * radius};
}

Eigen::Index SphereRow::period() const noexcept {
    const auto both = static_cast<Eigen::Index>(std::lcm(solids_.size(), diameters_m_.size()));
    return taper_ == 0 && drawn_ == nullptr ? std::min(both, spheres_) : spheres_;
}

Eigen::Index SphereRow::distinct() const noexcept {
    return std::min(period() + 1, spheres_);
}

const std::string& last_material(const Scene& scene) noexcept {
    const Spheres& chain = scene.chain;
    return chain.materials.empty()
               ? chain.material
               : chain.materials[static_cast<std::size_t>(chain.spheres - 1) % chain.materials.size()];
}

std::vector<std::string> sphere_materials(const Scene& scene) {
    if (scene.chain.materials.empty()) {
        return {scene.chain.material};
    }
    std::vector<std::string> names;
    for (std::size_t i = 0; i < std::min<std::size_t>(scene.chain.materials.size(), scene.chain.spheres);
         ++i) {
        if (std::ranges::find(names, scene.chain.materials[i]) == names.end()) {
            names.push_back(scene.chain.materials[i]);
        }
    }
    return names;
}

double contact_stiffness(const Sphere& a, const Sphere& b) noexcept {
    const double theta =
        a.solid == b.solid ? plane_strain_modulus(*a.solid) / 2 : contact_modulus(*a.solid, *b.solid);
    return 4 * std::sqrt(in_series(a.radius_m, b.radius_m)) / 3 * theta;
}

double reduced_mass(const Sphere& a, const Sphere& b) noexcept {
    return in_series(a.mass_kg, b.mass_kg);
}

}  // namespace hertzline
