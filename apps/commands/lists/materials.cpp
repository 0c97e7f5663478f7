// hertzline materials: the built-in materials, with their numbers and sources.

#include "core/scene/materials.hpp"

#include <memory>
#include <optional>
#include <string>
#include <variant>

#include <fmt/format.h>

#include "apps/command.hpp"
#include "apps/console/output.hpp"

namespace hertzline::app {

namespace {

constexpr const char* materials_examples =
    "E Young's modulus, nu Poisson's ratio, c speed of longitudinal waves, Z acoustic impedance,\n"
    "Y yield strength, sf flexural strength of solids that break before they yield.\n"
    "Solids are for drive.material, chain.material and end.material, fluids for medium.material.\n"
    "A scene may define its own: [materials.NAME], see scenes/README.md.\n"
    "Examples:\n"
    "  hertzline materials\n"
    "  hertzline run paper-vitreous-carbon --set end.material=fused_silica";

double density(const Material& material) {
    return std::visit([](const auto& sort) { return sort.density_kg_per_m3; }, material);
}

/// Speed of longitudinal waves [m/s].
double sound_speed(const Material& material) {
    return acoustic_impedance(material) / density(material);
}

Json or_null(const std::optional<double>& value) {
    return value ? Json(*value) : Json(nullptr);
}

/// In MPa.
std::string strength_text(const Solid* solid, std::optional<double> Solid::*strength) {
    return solid != nullptr && solid->*strength ? fmt::format("{:.4g}", *(solid->*strength) / 1e6) : "-";
}

Json json_of(const BuiltInMaterial& row) {
    Json json;
    const auto* solid = std::get_if<Solid>(&row.material);
    json["name"] = row.name;
    json["sort"] = solid != nullptr ? "solid" : "fluid";
    json["youngs_modulus_pa"] = solid != nullptr ? Json(solid->youngs_modulus_pa) : Json(nullptr);
    json["poissons_ratio"] = solid != nullptr ? Json(solid->poissons_ratio) : Json(nullptr);
    json["density_kg_per_m3"] = density(row.material);
    json["sound_speed_m_per_s"] = sound_speed(row.material);
    json["impedance_pa_s_per_m"] = acoustic_impedance(row.material);
    json["yield_strength_pa"] = solid != nullptr ? or_null(solid->yield_strength_pa) : Json(nullptr);
    json["flexural_strength_pa"] = solid != nullptr ? or_null(solid->flexural_strength_pa) : Json(nullptr);
    json["source"] = row.source;
    return json;
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
        list.push_back(json_of(row));
        text += text_of(row);
    }
    print(format == Format::json ? json_text(list) + '\n' : text);
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
