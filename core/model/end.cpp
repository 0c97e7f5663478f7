#include "core/model/end.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/model/contact_law.hpp"
#include "core/model/drive.hpp"
#include "core/model/sphere_row.hpp"
#include "core/scene/elements.hpp"
#include "core/scene/text.hpp"

namespace hertzline {

std::vector<Layer> layers_of(const Scene& scene) {
    const End& end = scene.end;
    if (end.materials.empty()) {
        return {{solid_of(scene, end.material), end.thickness_m, end.loss_factor}};
    }
    std::vector<Layer> layers;
    for (std::size_t i = 0; i < end.materials.size(); ++i) {
        layers.push_back({solid_of(scene, end.materials[i]), end.thicknesses_m[i],
                          end.loss_factors.empty() ? end.loss_factor : end.loss_factors[i]});
    }
    return layers;
}

const std::string& touched_material(const Scene& scene) noexcept {
    const End& end = scene.end;
    return end.kind == EndKind::plate && !end.materials.empty() ? end.materials.front() : end.material;
}

double plate_mass(const Scene& scene) {
    double mass = 0;
    for (const Layer& layer : layers_of(scene)) {
        mass += layer.solid.density_kg_per_m3 * std::numbers::pi * scene.end.radius_m * scene.end.radius_m *
                layer.thickness_m;
    }
    return mass;
}

double plate_stiffness(const Scene& scene) {
    return scene.end.stiffness_n_per_m
               ? *scene.end.stiffness_n_per_m
               : central_stiffness(laminate(layers_of(scene)).section, scene.end.radius_m);
}

double transmission(double impedance_a, double impedance_b) noexcept {
    const double reflection = (impedance_b - impedance_a) / (impedance_b + impedance_a);
    return 1 - reflection * reflection;
}

double output_transmission(const Scene& scene) {
    const double sphere = acoustic_impedance(*find_material(scene, last_material(scene)));
    const double medium = acoustic_impedance(*find_material(scene, scene.medium.material));
    double product = 1;
    double before = sphere;
    for (const Layer& layer : layers_of(scene)) {
        const double impedance = acoustic_impedance(layer.solid);
        product *= transmission(before, impedance);
        before = impedance;
    }
    return std::sqrt(product * transmission(before, medium));
}

namespace {

/// Nothing: the preload is held by a constant force on the last sphere.
EndModel free_end() {
    EndModel end;
    end.loaded = EndLoad::last_sphere;
    return end;
}

/// A half-space that does not move as a whole.
EndModel wall(const Scene& scene) {
    EndModel end;
    const Sphere last = SphereRow(scene).last();
    end.contact_stiffness =
        flat_sphere_stiffness(solid_of(scene, touched_material(scene)), *last.solid, last.radius_m);
    return end;
}

/// The paper's plate: one spring, and a quarter of the disc's mass.
EndModel plate(const Scene& scene) {
    EndModel end = wall(scene);
    end.loaded = scene.end.preload == PlatePreload::as_printed ? EndLoad::unbalanced : EndLoad::end;
    end.body = {.inv_mass = 4 / plate_mass(scene), .spring = plate_stiffness(scene)};
    end.has_plate = true;
    end.transmission = output_transmission(scene);
    return end;
}

/// The disc with its modes and its fluid.
EndModel modal_plate(const Scene& scene) {
    EndModel end = wall(scene);
    end.plate = plate_response(plate_parameters(scene), plate_poles(scene));
    end.body = {.inv_mass = end.plate->mobility};
    end.loaded = EndLoad::end;
    return end;
}

}  // namespace

double fastest_contact_hz(const Scene& scene) {
    const SphereRow row(scene);
    const double first_mass = row[0].mass_kg;
    const double velocity =
        std::max(largest_velocity(scene.drive), std::abs(scene.chain.impact_velocity_m_per_s));
    const double weight = std::max(0.0, scene.chain.gravity_m_per_s2);
    // with weights no two contacts are alike
    const Eigen::Index spheres = std::max<Eigen::Index>(2, weight > 0 ? row.size() : row.distinct());
    double fastest = 0;
    double force = drawn_preload_n(scene);
    Sphere a = row[0];
    for (Eigen::Index i = 1; i < spheres; ++i) {
        const Sphere b = row.size() > 1 ? row[i] : a;
        force += weight * a.mass_kg;
        const double stiffness = contact_stiffness(a, b);
        const double mass = 2 * reduced_mass(a, b);
        // two spheres that meet at twice the horn's velocity: all energy in the contact (K. L. Johnson, 1985, equation 11.22). Lighter ones
        // than the first have become faster, by its energy at most.
        const double faster = std::max(1.0, first_mass / std::min(a.mass_kg, b.mass_kg));
        const double of_impact =
            std::pow(1.25 * 0.5 * mass * 4 * velocity * velocity * faster / stiffness, 0.4);
        const double overlap = std::max(of_impact, static_overlap(stiffness, force));
        fastest = std::max(fastest, std::sqrt(4 * 1.5 * stiffness * std::sqrt(overlap) / mass));
        a = b;
    }
    return fastest / (2 * std::numbers::pi);
}

namespace {

/// A frequency of a scene, and how far above it a plate's response counts.
struct BandLimit {
    double frequency_hz;
    double times;
    const char* source;
    const char* remedy;

    double hz() const noexcept { return times * frequency_hz; }
};

BandLimit highest_band_limit(const Scene& scene, const PlateParameters& plate) {
    constexpr double of_drive = 10;
    double drive_hz = highest_frequency_hz(scene.drive);
    if (scene.drive.kind == DriveKind::none) {  // the usual band then, as far as there are tables
        constexpr double below = 1 - 1e-9;
        const double most_hz =
            below * largest_ka * plate.fluid.sound_speed_m_per_s / (2 * std::numbers::pi * plate.radius_m);
        drive_hz = std::min(drive_hz, most_hz / of_drive);
    }
    const std::array limits{
        BandLimit{plate.contact_hz, 5, "the fastest contacts", "larger or softer spheres"},
        BandLimit{drive_hz, of_drive, "the drive", "a slower drive"},
        BandLimit{highest_dry_hz(plate), 1.5, "the last mode", "fewer end.modes"}};
    return *std::ranges::max_element(limits, {}, &BandLimit::hz);
}

}  // namespace

PlateParameters plate_parameters(const Scene& scene) {
    const auto& fluid = std::get<Fluid>(*find_material(scene, scene.medium.material));
    const PlateSection section = laminate(layers_of(scene)).section;
    PlateParameters parameters{.section = scene.end.theory == PlateTheory::thin ? thin(section) : section,
                               .fluid = fluid,
                               .radius_m = scene.end.radius_m,
                               .modes = static_cast<int>(scene.end.modes),
                               .load = scene.medium.load,
                               .hydrophone_m = scene.output.hydrophone_m};
    // rounded up to a quarter of an octave: scenes whose chains differ a little have the same plate, which is fitted once
    parameters.contact_hz = std::exp2(std::ceil(4 * std::log2(fastest_contact_hz(scene))) / 4);
    parameters.band_hz = highest_band_limit(scene, parameters).hz();
    return parameters;
}

std::vector<Fault> plate_faults(const Scene& scene) {
    if (scene.end.kind != EndKind::plate) {
        return {};
    }
    constexpr double least_shear_ratio = 0.05;
    if (const double ratio = laminate(layers_of(scene)).shear_ratio; !(ratio >= least_shear_ratio)) {
        return {{"end.materials",
                 "layers whose shear stiffness is " + rounded_text(ratio, 3) + " of 5/6 of the sum of G h",
                 "at least " + number_text(least_shear_ratio) +
                     ": with a softer layer between stiff ones the disc does not bend as one plate"}};
    }
    if (scene.end.model != PlateModel::modal) {
        return {};
    }
    constexpr double fastest_mode = 50;  // over the contacts' frequency
    const PlateParameters p = plate_parameters(scene);
    std::vector<Fault> faults;
    const double ka = 2 * std::numbers::pi * p.band_hz * p.radius_m / p.fluid.sound_speed_m_per_s;
    if (!(ka <= largest_ka)) {
        const BandLimit limit = highest_band_limit(scene, p);
        faults.push_back(
            {"end.radius_m",
             number_text(p.radius_m) + ", k a = " + rounded_text(ka, 3) + " at " +
                 rounded_text(limit.hz(), 3) + " Hz, " + number_text(limit.times) +
                 " times the frequency of " + limit.source,
             "k a of at most " + number_text(largest_ka) + " there: a smaller disc, or " + limit.remedy});
    }
    const double dry = highest_dry_hz(p);
    const double highest = fastest_mode * fastest_contact_hz(scene);
    if (highest == 0) {
        faults.push_back({"chain.preload_n", "0, without a motion of the horn or of spheres at the start",
                          "a preload or a motion: else nothing presses on the disc"});
    } else if (!(dry <= highest)) {
        faults.push_back({"end.modes",
                          number_text(scene.end.modes) + ", the last of " + rounded_text(dry, 3) + " Hz",
                          "modes of at most " + rounded_text(highest, 3) + " Hz, " +
                              number_text(fastest_mode) + " times the frequency of the fastest contacts"});
    }
    return faults;
}

std::vector<Fault> response_faults(const Scene& scene) {
    const int poles = plate_poles(scene);
    if (poles == 0) {
        return {};
    }
    constexpr double largest_error = 0.1;
    const auto response = plate_response(plate_parameters(scene), poles);
    if (response->fit_error() <= largest_error) {
        return {};
    }
    return {{"end.model",
             "\"modal\", whose response " + number_text(static_cast<std::int64_t>(poles)) +
                 " poles fit with an error of " + number_text(response->fit_error()),
             "a disc whose response is fitted to " + number_text(largest_error)}};
}

int plate_poles(const Scene& scene) {
    if (scene.end.kind != EndKind::plate || scene.end.model != PlateModel::modal) {
        return 0;
    }
    return scene.numerics.poles
               ? static_cast<int>(*scene.numerics.poles)
               : poles_for(plate_parameters(scene), scene.numerics.accuracy.value_or(default_accuracy));
}

EndModel end_model(const Scene& scene) {
    switch (scene.end.kind) {
        case EndKind::plate:
            return scene.end.model == PlateModel::modal ? modal_plate(scene) : plate(scene);
        case EndKind::wall:
            return wall(scene);
        case EndKind::free:
            return free_end();
    }
    return {};
}

}  // namespace hertzline
