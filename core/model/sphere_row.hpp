#pragma once
// The spheres of a chain, one by one: materials and diameters that repeat along it, and its taper (docs/model.md, section 3).

#include <string>
#include <vector>

#include <Eigen/Core>

#include "hertzline/scene.hpp"

namespace hertzline {

struct Sphere {
    const Solid* solid = nullptr;
    double radius_m = 0;
    double mass_kg = 0;
};

class SphereRow {
public:
    /// @param scene has passed validate(), and outlives the object
    explicit SphereRow(const Scene& scene);

    Eigen::Index size() const noexcept { return spheres_; }
    /// @param number from 0 at the horn
    Sphere operator[](Eigen::Index number) const noexcept;
    const std::string& material(Eigen::Index number) const noexcept { return *names_[of(number, names_)]; }
    Sphere last() const noexcept { return (*this)[spheres_ - 1]; }

    /// Spheres after which their materials repeat.
    Eigen::Index material_period() const noexcept { return static_cast<Eigen::Index>(names_.size()); }
    /// Spheres until all of them have occurred beside all of their neighbours: further ones repeat them.
    Eigen::Index distinct() const noexcept;
    /// Spheres after which the row repeats itself; size() where it does not.
    Eigen::Index period() const noexcept;
    bool uniform() const noexcept { return period() == 1 || spheres_ == 1; }

private:
    template <class Entries>
    static std::size_t of(Eigen::Index number, const Entries& entries) noexcept {
        return static_cast<std::size_t>(number) % entries.size();
    }

    Eigen::Index spheres_;
    std::vector<const std::string*> names_;
    std::vector<const Solid*> solids_;
    std::vector<double> diameters_m_;
    double taper_;
    const Scene* drawn_ = nullptr;  ///< whose tolerance draws each diameter; null: there is none
};

/// The material of the last sphere.
const std::string& last_material(const Scene& scene) noexcept;

/// The materials of the spheres, each once, in their order along the chain.
std::vector<std::string> sphere_materials(const Scene& scene);

/// Stiffness of the contact of two spheres [N/m^(3/2)]: 4/3 sqrt(R_a R_b/(R_a + R_b)) theta_ab.
double contact_stiffness(const Sphere& a, const Sphere& b) noexcept;

/// 1/(1/m_a + 1/m_b) [kg]
double reduced_mass(const Sphere& a, const Sphere& b) noexcept;

}  // namespace hertzline
