// hertzline materials: the built-in materials, with their numbers and sources.

#include "hertzline/materials.hpp"

#include <memory>
#include <optional>
#include <string>
#include <variant>

#include <fmt/format.h>

#include "apps/command.hpp"
#include "apps/console/output.hpp"
#include "core/scene/scene_json.hpp"

namespace hertzline::app {

namespace {

constexpr const char* materials_examples =
    "E Young's modulus, nu Poisson's ratio, c speed of longitudinal waves, Z acoustic impedance, "
    "Y yield strength, sf flexural strength of solids that break before they yield.\n"
    "Solids are for drive.material, chain.material and end.material, fluids for medium.material.\n"
    "A scene may define its own: [materials.NAME], see scenes/README.md.\n"
    "Examples:\n"
    "  hertzline materials\n"
    "  hertzline run paper-vitreous-carbon --set end.material=fused_silica";

double density(const Material& material) {
    return std::visit([](const auto& sort) { return sort.density_kg_per_m3; }, material);
}

/// Returns the speed of longitudinal waves [m/s].
double sound_speed(const Material& material) {
    return acoustic_impedance(material) / density(material);
}

/// Returns a strength in MPa, or "-".
std::string strength_text(const Solid* solid, std::optional<double> Solid::*strength) {
    return solid != nullptr && solid->*strength ? fmt::format("{:.4g}", *(solid->*strength) / 1e6) : "-";
}

std::string text_of(const BuiltInMaterial& row) {
    const auto* solid = std::get_if<Solid>(&row.material);
    return fmt::format("{:<17} {:>7} {:>6} {:>9.4g} {:>7.0f} {:>9.4g} {:>7} {:>8}   {}\n", row.name,
                       solid != nullptr ? fmt::format("{:.4g}", solid->youngs_modulus_pa / 1e9) : "-",
                       solid != nullptr ? fmt::format("{:.3g}", solid->poissons_ratio) : "-",
                       density(row.material), sound_speed(row.material),
                       acoustic_impedance(row.material) / 1e6,
                       strength_text(solid, &Solid::yield_strength_pa),
                       strength_text(solid, &Solid::flexural_strength_pa), row.source);
}

Exit list_materials(Format format) {
    Json list = Json::array();
    std::string text = fmt::format("{:<17} {:>7} {:>6} {:>9} {:>7} {:>9} {:>7} {:>8}   {}\n", "", "E [GPa]",
                                   "nu", "[kg/m^3]", "c [m/s]", "Z [MRayl]", "Y [MPa]", "sf [MPa]", "source");
    for (const BuiltInMaterial& row : built_in_materials()) {
        list.push_back(material_json(row));
        text += text_of(row);
    }
    print_listing(format == Format::json ? json_text(list) + '\n' : text);
    return Exit::done;
}

}  // namespace

Run materials_command(CLI::App& app) {
    auto format = std::make_shared<Format>(Format::text);
    add_format_option(app, *format, "print JSON, all numbers in SI units");
    app.footer(materials_examples);
    return [format] { return list_materials(*format); };
}

}  // namespace hertzline::app
