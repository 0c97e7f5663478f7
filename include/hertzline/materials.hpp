#pragma once
// Materials by name: elastic solids for bodies, fluids for the medium. All SI.

#include <optional>
#include <span>
#include <string_view>
#include <variant>

namespace hertzline {

/// An isotropic elastic solid.
struct Solid {
    double youngs_modulus_pa = 0;
    double poissons_ratio = 0;
    double density_kg_per_m3 = 0;
    std::optional<double>
        yield_strength_pa{};  ///< of a material that flows; unset: unknown, or it breaks first
    std::optional<double> flexural_strength_pa{};  ///< of a material that breaks before it flows
    bool operator==(const Solid&) const = default;
};

/// A fluid that carries sound.
struct Fluid {
    double density_kg_per_m3 = 0;
    double sound_speed_m_per_s = 0;
    bool operator==(const Fluid&) const = default;
};

using Material = std::variant<Solid, Fluid>;

enum class MaterialSort { solid, fluid };

inline MaterialSort sort_of(const Material& material) noexcept {
    return std::holds_alternative<Solid>(material) ? MaterialSort::solid : MaterialSort::fluid;
}

/// A row of the table of built-in materials.
struct BuiltInMaterial {
    std::string_view name;
    Material material;
    std::string_view source;  ///< where the numbers come from
};

/// The materials that every scene knows.
std::span<const BuiltInMaterial> built_in_materials() noexcept;

/// Plane-strain modulus E / (1 - nu^2) [Pa], the theta of Hertz's contact law (Johnson 1985, eq. 4.20).
double plane_strain_modulus(const Solid& solid) noexcept;

/// Specific acoustic impedance [Pa s/m]: for a solid sqrt(rho M) with the longitudinal modulus M, for a fluid rho c.
double acoustic_impedance(const Material& material) noexcept;

}  // namespace hertzline
