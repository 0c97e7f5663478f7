#include "core/model/validity.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <string_view>

#include "core/model/contact_law.hpp"
#include "core/model/drive.hpp"
#include "core/model/sampled_motion.hpp"
#include "core/model/sphere_row.hpp"
#include "core/model/strength.hpp"
#include "core/scene/elements.hpp"
#include "core/scene/scene_key.hpp"
#include "core/scene/text.hpp"

namespace hertzline {

namespace {

/// Hertz's law takes the contact for small beside the sphere: at this overlap its radius is 0.16 R between spheres.
constexpr double deepest_overlap = 0.05;
/// Thickness over radius of a disc that bends as a thin plate does.
constexpr double thickest_disc = 0.2;
constexpr double beyond_cut_off = 2;      // drive over the chain's highest frequency
constexpr double shortest_in_thin = 1.5;  // k_b h of a mode
constexpr double shortest_in_thick = 3;   // the same with shear and rotary inertia
constexpr double largest_mass_ka = 0.5;   // of a fluid that is taken for a mass
constexpr double most_shear = 0.012;      // D/(S_h a^2) of a thin plate: that of aluminium at thickest_disc
constexpr double widest_contact = 0.3;  // radius of a contact over the thickness of the layer that it touches
constexpr double damped_diameter_m = 1e-3;  // of the spheres for which the paper gives its dashpot

/// Two digits.
std::string briefly(double value) {
    return rounded_text(value, 2);
}

/// A number whose size suggests that another unit was meant.
struct SuspiciousUnit {
    std::string_view key;
    double value;
    bool odd;
    std::string_view unit;
    std::string_view meant;
};

void warn_of_suspicious_units(std::span<const SuspiciousUnit> values, std::vector<std::string>& warnings) {
    for (const SuspiciousUnit& value : values) {
        if (value.odd) {
            warnings.push_back(std::string(value.key) + " is " + number_text(value.value) + " " +
                               std::string(value.unit) + "; were " + std::string(value.meant) + " meant?");
        }
    }
}

/// Solids softer than any gel or lighter than any foam.
void add_units_of_materials(const Scene& s, std::vector<std::string>& warnings) {
    std::vector<std::string> solids = sphere_materials(s);
    if (s.drive.kind != DriveKind::none) {
        solids.push_back(s.drive.material);
    }
    if (s.end.kind != EndKind::free) {
        const bool layered = s.end.kind == EndKind::plate && !s.end.materials.empty();
        const std::vector<std::string> disc{s.end.material};
        std::ranges::copy(layered ? s.end.materials : disc, std::back_inserter(solids));
    }
    std::ranges::sort(solids);
    solids.erase(std::unique(solids.begin(), solids.end()), solids.end());
    for (const std::string& name : solids) {
        const Solid& solid = solid_of(s, name);
        const std::string modulus = "materials." + name + ".youngs_modulus_pa";
        const std::string density = "materials." + name + ".density_kg_per_m3";
        warn_of_suspicious_units(
            std::array{SuspiciousUnit{modulus, solid.youngs_modulus_pa, solid.youngs_modulus_pa < 5e3, "Pa",
                                      "gigapascals"},
                       SuspiciousUnit{density, solid.density_kg_per_m3, solid.density_kg_per_m3 < 25,
                                      "kg/m^3", "grams per cubic centimetre"}},
            warnings);
    }
}

void add_units(const Scene& s, std::vector<std::string>& warnings) {
    const bool plate = s.end.kind == EndKind::plate;
    const std::array values{
        SuspiciousUnit{"chain.diameter_m", s.chain.diameter_m,
                       s.chain.diameters_m.empty() && s.chain.diameter_m >= 0.1, "m", "millimetres"},
        SuspiciousUnit{"end.radius_m", s.end.radius_m, plate && s.end.radius_m >= 0.5, "m", "millimetres"},
        SuspiciousUnit{"end.thickness_m", s.end.thickness_m,
                       plate && s.end.thicknesses_m.empty() && s.end.thickness_m >= 0.05, "m", "millimetres"},
        SuspiciousUnit{"drive.amplitude_m", s.drive.amplitude_m,
                       s.drive.kind != DriveKind::file && std::abs(s.drive.amplitude_m) >= 1e-3, "m",
                       "micrometres"},
        SuspiciousUnit{"drive.frequency_hz", s.drive.frequency_hz, s.drive.frequency_hz < 1000, "Hz",
                       "kilohertz"},
    };
    warn_of_suspicious_units(values, warnings);
    const auto look_at_list = [&](const std::string& name, std::span<const double> list, double odd) {
        const auto first = std::ranges::find_if(list, [odd](double length) { return length >= odd; });
        if (first != list.end()) {
            const std::string key = name + "[" + std::to_string(first - list.begin() + 1) + "]";
            warn_of_suspicious_units(std::array{SuspiciousUnit{key, *first, true, "m", "millimetres"}},
                                     warnings);
        }
    };
    look_at_list("chain.diameters_m", s.chain.diameters_m, 0.1);
    if (plate) {
        look_at_list("end.thicknesses_m", s.end.thicknesses_m, 0.05);
    }
    add_units_of_materials(s, warnings);
}

/// Static displacement of the plate's centre per newton [m/N]; 0 of a disc without stiffness, which does not rest.
double compliance(const EndModel& end) {
    if (!end.plate) {
        return end.body.spring > 0 ? 1 / end.body.spring : 0;
    }
    double sum = 0;
    for (const PlateMode& mode : end.plate->modes) {
        sum += 1 / mode.stiffness_n_per_m;
    }
    return sum;
}

/// A disc that bends too far for a linear plate.
std::optional<std::string> bent_too_far(const Scene& scene, std::string_view bends, double by_m) {
    if (scene.end.kind != EndKind::plate ||
        !(std::abs(by_m) > laminate(layers_of(scene)).section.thickness_m / 2)) {
        return std::nullopt;
    }
    return std::string(bends) + " the disc by " + briefly(std::abs(by_m)) +
           " m, more than half its thickness; a disc that bends so far stiffens, which the model leaves out";
}

constexpr std::string_view remedy = "; end.theory = \"thick\" has the shear that is missing";

/// The lowest and the highest frequency of a drive, 0 where there is none [Hz].
std::array<double, 2> frequencies_of(const Drive& drive) noexcept {
    if (drive.kind == DriveKind::none) {
        return {0, 0};
    }
    const double last =
        drive.kind == DriveKind::file ? drive.frequency_hz : drive.sweep_to_hz.value_or(drive.frequency_hz);
    return {std::min(drive.frequency_hz, last), std::max(drive.frequency_hz, last)};
}

/// Modes whose waves are too short for the theory, and a fluid that is taken for a mass where it is not.
void add_modes(const Scene& scene, const PlateResponse& plate, std::vector<std::string>& warnings) {
    const bool thin = scene.end.theory == PlateTheory::thin;
    for (std::size_t n = 0; n < plate.modes.size(); ++n) {
        if (plate.modes[n].kb_h > (thin ? shortest_in_thin : shortest_in_thick)) {
            warnings.push_back(
                "mode " + std::to_string(n + 1) + " of the disc has k_b h = " + briefly(plate.modes[n].kb_h) +
                (thin ? "; thin-plate theory is for less than 1.5, and its frequency of " +
                            briefly(plate.modes[n].dry_hz) + " Hz is overestimated" + std::string(remedy)
                      : "; thick-plate theory is for less than 3: a plate has other waves than bending ones "
                        "there"));
            break;  // higher ones are worse
        }
    }
    const bool driven = scene.drive.kind != DriveKind::none;
    const double highest_hz = driven ? highest_frequency_hz(scene.drive) : fastest_contact_hz(scene);
    if (driven && plate.modes.back().wet_hz < highest_hz) {
        warnings.push_back("the highest mode of the disc (end.modes) has " +
                           briefly(plate.modes.back().wet_hz) + " Hz in the fluid, below the drive's " +
                           briefly(highest_hz) + " Hz: modes that would answer there are left out");
    }
    const double ka =
        2 * std::numbers::pi * highest_hz * scene.end.radius_m / plate.parameters.fluid.sound_speed_m_per_s;
    if (scene.medium.load == FluidLoad::added_mass && ka > largest_mass_ka) {
        warnings.push_back("medium.load is \"added_mass\" with k a = " + briefly(ka) +
                           (driven ? " at the drive's frequency" : " at the frequency of the contacts") +
                           "; above 0.5 the fluid radiates more than it weighs");
    }
}

/// A contact that reaches through the layer that it touches. Its radius is that of the rest, or of a last sphere as fast as the horn.
void add_touched_layer(const Scene& scene, const Chain& chain, std::vector<std::string>& warnings) {
    const std::vector<Layer> layers = layers_of(scene);
    const Eigen::Index last = chain.spheres();
    const Sphere sphere = SphereRow(scene).last();
    const double velocity =
        std::max(largest_velocity(scene.drive), std::abs(scene.chain.impact_velocity_m_per_s));
    // (2/5) k d^(5/2) = m v^2/2
    const double of_impact =
        std::pow(1.25 * sphere.mass_kg * velocity * velocity / chain.stiffness[last], 0.4);
    const double radius_m = std::sqrt(sphere.radius_m * std::max(of_impact, chain.static_overlap[last]));
    if (layers.size() > 1 && radius_m > widest_contact * layers.front().thickness_m) {
        warnings.push_back("the last sphere's contact has a radius of about " + briefly(radius_m) +
                           " m, on a layer of " + briefly(layers.front().thickness_m) +
                           " m (end.thicknesses_m); Hertz's law takes that layer for a half-space");
    }
}

void add_plate(const Scene& scene, const Chain& chain, std::vector<std::string>& warnings) {
    if (scene.end.kind != EndKind::plate) {
        return;
    }
    const PlateSection section = laminate(layers_of(scene)).section;
    const double ratio = section.thickness_m / scene.end.radius_m;
    const double shear =
        section.bending_n_m / (section.shear_n_per_m * scene.end.radius_m * scene.end.radius_m);
    const bool modal = scene.end.model == PlateModel::modal;
    const bool by_theory = modal ? scene.end.theory == PlateTheory::thin : !scene.end.stiffness_n_per_m;
    if (ratio > thickest_disc && by_theory) {
        warnings.push_back("the disc's thickness is " + briefly(ratio) +
                           " of its radius; above 0.2 it is no thin plate, and its stiffness and frequency "
                           "are overestimated" +
                           (modal ? std::string(remedy) : ""));
    } else if (shear > most_shear && by_theory && layers_of(scene).size() > 1) {
        warnings.push_back(
            "the disc's layers shear: D/(S_h a^2) is " + briefly(shear) +
            "; above 0.012 it is no thin plate, and its stiffness and frequency are overestimated" +
            (modal ? std::string(remedy) : ""));
    }
    add_touched_layer(scene, chain, warnings);
    if (chain.end.plate) {
        add_modes(scene, *chain.end.plate, warnings);
    }
    if (auto bent = bent_too_far(
            scene, scene.chain.gravity_m_per_s2 == 0 ? "the preload bends" : "preload and weight bend",
            sag_at_rest(chain))) {
        warnings.push_back(*std::move(bent));
    }
}

/// A record that moves on at its end, loses much to the low-pass, drifts, or has few samples.
void add_record(const Scene& scene, std::vector<std::string>& warnings) {
    const Drive& drive = scene.drive;
    if (!has_samples(drive)) {
        return;
    }
    const RecordFacts& record = SampledMotion::of(drive)->facts();
    const auto percent = [](double share) { return briefly(100 * share) + " %"; };
    if (record.largest_velocity == 0) {
        warnings.emplace_back("the drive's record does not move: all of its samples are alike");
    }
    constexpr double noticed = 0.01;
    if (record.end_share > noticed && drive.start_s + record.duration_s < scene.output.duration_s) {
        warnings.push_back("the drive's record ends amid a motion, at " + percent(record.end_share) +
                           " of its largest velocity: there it stops at once");
    }
    if (record.beyond_share > noticed) {
        warnings.push_back("the low-pass at " + briefly(lowpass_hz(drive)) + " Hz (drive.lowpass_hz) takes " +
                           (record.beyond_share < 1 ? percent(record.beyond_share) : "most") +
                           " of the drive's record");
    }
    if (record.noise_velocity > noticed * record.largest_velocity) {
        warnings.push_back("the noise of the drive's record moves the horn at up to " +
                           briefly(record.noise_velocity) + " m/s rms, " +
                           percent(record.noise_velocity / record.largest_velocity) +
                           " of its largest velocity; a lower drive.lowpass_hz takes more of it");
    }
    if (record.drift_removed) {
        warnings.push_back("the drive's record drifts by " + briefly(record.drift_m_per_s) +
                           " m/s, which is removed");
    }
    constexpr double far = 0.03;  // of the largest displacement
    if (!record.drift_removed && record.end_displacement_m > far * record.largest_displacement_m) {
        warnings.push_back("the drive's record ends " + briefly(record.end_displacement_m) +
                           " m from its beginning, " +
                           percent(record.end_displacement_m / record.largest_displacement_m) +
                           " of its largest displacement, and the horn stays there; a drift of the "
                           "instrument, which its ends do not show, has to be taken off first");
    }
    if (scene.numerics.rest_tolerance != 0 && record.end_displacement_m > 0) {
        warnings.emplace_back(
            "numerics.rest_tolerance has no effect with a record that does not end where it began");
    }
    constexpr double fewest = 7;  // samples in a period of a spline of degree 7 that errs by 1e-6
    if (const double samples = *drive.sample_rate_hz / record.mean_frequency_hz;
        samples < fewest && record.largest_velocity > 0) {
        warnings.push_back("the drive's record has " + briefly(samples) +
                           " samples in a period of its mean frequency; with less than 7 the motion between "
                           "them is not certain");
    }
    warn_of_suspicious_units(
        std::array{SuspiciousUnit{"the largest displacement of the drive's record",
                                  record.largest_displacement_m, record.largest_displacement_m >= 1e-3, "m",
                                  "micrometres (drive.scale), or a velocity (drive.quantity),"}},
        warnings);
}

/// A dashpot of the paper's spheres on others.
void add_damping(const Scene& scene, std::vector<std::string>& warnings) {
    const Scene paper;
    if (scene.chain.damping_law != DampingLaw::dashpot ||
        scene.chain.damping_kg_per_s != paper.chain.damping_kg_per_s) {
        return;
    }
    const std::vector<std::string> materials = sphere_materials(scene);
    const SphereRow row(scene);
    std::optional<double> other_m;
    for (Eigen::Index i = 0; i < row.distinct() && !other_m; ++i) {
        const double diameter_m = 2 * row[i].radius_m;
        constexpr double noticed = 0.25;
        if (std::abs(diameter_m / damped_diameter_m - 1) > noticed) {
            other_m = diameter_m;
        }
    }
    if (materials != std::vector{paper.chain.material} || other_m) {
        warnings.push_back("chain.damping_kg_per_s is " + number_text(scene.chain.damping_kg_per_s) +
                           ", which the paper gives for spheres of 1 mm of " + paper.chain.material +
                           "; the spheres are of " + enumeration(materials) +
                           (other_m ? ", with a diameter of " + briefly(*other_m) + " m" : "") +
                           " (docs/model.md, section 3, \"Other spheres\")");
    }
}

/// A tip that goes further than its steady state, or does not reach it.
void add_resonator(const Drive& drive, std::vector<std::string>& warnings) {
    const auto peak = tip_peak(drive);
    constexpr double noticed = 0.2;
    if (peak && std::abs(peak->x / drive.amplitude_m - 1) > noticed) {
        warnings.push_back("the horn's tip moves by " + briefly(peak->x) + " m within the burst, " +
                           briefly(peak->x / drive.amplitude_m) +
                           " of drive.amplitude_m, which is that of the steady state");
    }
}

/// When the wave of the horn, or of the spheres that start with a velocity, can reach the end of the chain: none is faster than a long
/// one in a chain pressed as far as the drive can. It goes a diameter in sqrt(m / k_t), and the cut-off is sqrt(4 k_t / m) / (2 pi).
double soonest_wave_of_chain_s(const Scene& scene) {
    const double of_a_sphere = 1 / (std::numbers::pi * fastest_contact_hz(scene));
    const auto after = [&](std::int64_t spheres) { return static_cast<double>(spheres) * of_a_sphere; };
    double soonest = std::numeric_limits<double>::infinity();
    if (scene.chain.impact_velocity_m_per_s != 0) {
        soonest = after(std::max<std::int64_t>(scene.chain.spheres - scene.chain.impact_spheres, 0));
    }
    if (scene.drive.kind != DriveKind::none) {
        soonest = std::min(soonest, scene.drive.start_s + after(scene.chain.spheres));
    }
    return std::isfinite(soonest) ? soonest : after(scene.chain.spheres);
}

/// The same of any chain of an array, without the delays of its drives; infinite where nothing presses or moves.
double soonest_wave_s(const Scene& scene) {
    double soonest = std::numeric_limits<double>::infinity();
    for (std::size_t element = 0; element < chains_of(scene); ++element) {
        Scene one = element_scene(scene, element);
        one.drive.start_s = scene.drive.start_s;
        soonest = std::min(soonest, soonest_wave_of_chain_s(one));
    }
    return soonest;
}

std::string deep_contact(double ratio, std::string_view when) {
    return "a contact is pressed " + briefly(ratio) + " of a sphere's radius deep" + std::string(when) +
           "; Hertz's law is for less than 0.05";
}

}  // namespace

double contact_pressure(double stiffness, double overlap_m, double radius_m) noexcept {
    return overlap_m > 0 ? 3 * stiffness * std::sqrt(overlap_m) / (2 * std::numbers::pi * radius_m) : 0;
}

double curvature_radius(const Chain& chain, Eigen::Index contact) noexcept {
    const Eigen::Index last = chain.spheres();
    if (contact == 0 || contact == last) {
        return chain.radius[contact == 0 ? 0 : last - 1];
    }
    return in_series(chain.radius[contact - 1], chain.radius[contact]);
}

ContactLoad contact_load(const Chain& chain, const Eigen::ArrayXd& overlaps) noexcept {
    ContactLoad load;
    const Eigen::Index last = chain.spheres();
    for (Eigen::Index c = 0; c <= last; ++c) {
        const double stiffness = chain.stiffness[c];
        if (stiffness == 0) {
            continue;  // nothing to touch
        }
        load.force_n = std::max(load.force_n, elastic_force(stiffness, overlaps[c]));
        double& pressure = load.pressures_pa[kind_of_contact(c, last)];
        pressure = std::max(pressure, contact_pressure(stiffness, overlaps[c], curvature_radius(chain, c)));
        const double smaller =
            std::min(chain.radius[std::max<Eigen::Index>(c - 1, 0)], chain.radius[std::min(c, last - 1)]);
        load.overlap_ratio = std::max(load.overlap_ratio, overlaps[c] / smaller);
    }
    load.pressure_pa = *std::max_element(load.pressures_pa.begin(), load.pressures_pa.end());
    return load;
}

std::optional<std::string> late_wave_warning(const Scene& scene) {
    const double soonest_s = soonest_wave_s(scene);
    if (scene.output.duration_s >= soonest_s || !std::isfinite(soonest_s)) {
        return std::nullopt;
    }
    return "the run ends after " + briefly(scene.output.duration_s) +
           " s (output.duration_s); the wave needs about " + briefly(soonest_s) +
           " s or more to reach the end of the chain";
}

std::vector<std::string> late_sound_warnings(const Scene& scene) {
    std::vector<std::string> warnings;
    if (!provides(scene, Requires::modal_plate)) {
        return warnings;
    }
    const double c = std::get<Fluid>(*find_material(scene, scene.medium.material)).sound_speed_m_per_s;
    const double wave_s = soonest_wave_s(scene);
    if (!std::isfinite(wave_s)) {
        return warnings;
    }
    const bool tone = scene.drive.kind == DriveKind::tone;  // a record may end with silence
    const double burst_s = tone ? scene.drive.start_s + burst_duration_s(scene.drive) : 0;
    const double end_s = scene.output.duration_s;
    const std::vector<double> delays_s = element_delays_s(scene);
    /// From the discs to a point: of the first sound, and of the last, which begins later by the delay of its element.
    const auto ways_s = [&](const std::array<double, 3>& point) {
        std::array<double, 2> ways{std::numeric_limits<double>::infinity(), 0};
        for (std::size_t i = 0; i < delays_s.size(); ++i) {
            const double x = is_array(scene) ? scene.array.x_m[i] : 0;
            const double y = is_array(scene) ? scene.array.y_m[i] : 0;
            const double aside = std::hypot(point[0] - x, point[1] - y) - scene.end.radius_m;
            const double way_s = delays_s[i] + std::hypot(std::max(aside, 0.0), point[2]) / c;
            ways = {std::min(ways[0], way_s), std::max(ways[1], way_s)};
        }
        return ways;
    };
    const auto look_at = [&](std::span<const std::array<double, 3>> points, const std::string& one) {
        std::size_t silent = 0;
        std::size_t cut = 0;
        double latest_s = 0;
        double last_s = 0;
        for (const auto& point : points) {
            const auto [first, last] = ways_s(point);
            silent += wave_s + first > end_s ? 1 : 0;
            cut += burst_s + last > end_s ? 1 : 0;
            latest_s = std::max(latest_s, wave_s + first);
            last_s = std::max(last_s, burst_s + last);
        }
        const auto share = [&](std::size_t count) {
            return one.empty() ? number_text(static_cast<std::int64_t>(count)) + " of " +
                                     number_text(static_cast<std::int64_t>(points.size())) + " points"
                               : one;
        };
        const std::string ends = "the run ends after " + briefly(end_s) + " s (output.duration_s), ";
        if (silent > 0) {
            warnings.push_back(ends + "before the sound can reach " + share(silent) +
                               (one.empty() ? "; the last one needs about " : ", which needs about ") +
                               briefly(latest_s) + " s or more");
        } else if (cut > 0 && tone && burst_s <= end_s) {
            warnings.push_back(ends + "while the burst still arrives at " + share(cut) +
                               ": peaks and spectra there are those of its beginning; it needs " +
                               briefly(last_s) + " s or more");
        }
    };
    look_at(scene.output.points_m, "");
    const auto [x, y] = middle_of(scene.array);
    const std::array<double, 3> hydrophone{x, y, scene.output.hydrophone_m};
    look_at({&hydrophone, 1}, "the hydrophone (output.hydrophone_m)");
    return warnings;
}

std::vector<std::string> validity_warnings(const Scene& scene, const Chain& chain) {
    std::vector<std::string> warnings;
    add_units(scene, warnings);
    add_plate(scene, chain, warnings);
    add_record(scene, warnings);
    const ContactLoad rest = contact_load(chain, chain.static_overlap);
    if (rest.overlap_ratio > deepest_overlap) {
        warnings.push_back(deep_contact(rest.overlap_ratio, scene.chain.gravity_m_per_s2 == 0
                                                                ? " by the preload alone"
                                                                : " by preload and weight alone"));
    }
    const double highest = fastest_contact_hz(scene);
    if (const double lowest = frequencies_of(scene.drive)[0];
        scene.chain.spheres > 1 && lowest > beyond_cut_off * highest) {
        warnings.push_back("the drive's frequency is " + briefly(lowest / highest) +
                           " times the highest that the chain passes on, " + briefly(highest) +
                           " Hz; next to nothing of it reaches the end");
    }
    if (auto unjudged = unjudged_contacts(scene)) {
        warnings.push_back(*std::move(unjudged));
    }
    add_damping(scene, warnings);
    add_resonator(scene.drive, warnings);
    return warnings;
}

double sag_at_rest(const Chain& chain) noexcept {
    return chain.end.loaded == EndLoad::end ? chain.end_force_n * compliance(chain.end) : 0;
}

double plate_hz(const Chain& chain) noexcept {
    const EndMode& body = chain.end.body;
    return chain.end.plate ? chain.end.plate->modes.front().dry_hz
                           : std::sqrt(body.spring * body.inv_mass) / (2 * std::numbers::pi);
}

std::optional<std::string> bending_warning(const Scene& scene, double deflection_m) {
    return bent_too_far(scene, "the motion bends", deflection_m);
}

std::vector<std::string> validity_warnings(const ContactLoad& load) {
    if (load.overlap_ratio > deepest_overlap) {
        return {deep_contact(load.overlap_ratio, " by the motion")};
    }
    return {};
}

}  // namespace hertzline
