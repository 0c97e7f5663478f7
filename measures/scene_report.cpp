#include "measures/scene_report.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <numbers>
#include <optional>
#include <type_traits>
#include <utility>

#include <fmt/format.h>

#include "core/integrators/stability.hpp"
#include "core/model/chain.hpp"
#include "core/model/contact_law.hpp"
#include "core/model/drive.hpp"
#include "core/model/end.hpp"
#include "core/model/sampled_motion.hpp"
#include "core/model/sphere_row.hpp"
#include "core/model/strength.hpp"
#include "core/model/validity.hpp"
#include "core/scene/elements.hpp"
#include "core/scene/json.hpp"
#include "core/scene/scene_words.hpp"
#include "core/step_choice/step_advice.hpp"
#include "hertzline/simulation.hpp"
#include "measures/run.hpp"

namespace hertzline::measures {

namespace {

using Value = decltype(ReportRow::value);
using Report = std::vector<ReportRow>;

constexpr double two_pi = 2 * std::numbers::pi;

Value if_any(bool exists, double value) {
    return exists ? Value(value) : Value();
}

/// Adds the bands of two spheres in turn: small waves pass up to the first edge, and from the second to the third (L. Brillouin, Wave
/// Propagation in Periodic Structures, 1946, chapter 4).
void add_bands(Report& report, const SphereRow& row, double slope) {
    const double heavy = std::max(row[0].mass_kg, row[1].mass_kg);
    const double light = std::min(row[0].mass_kg, row[1].mass_kg);
    const auto add = [&](const char* label, const char* name, double per_mass) {
        report.push_back({"spheres", label, name, "Hz", std::sqrt(2 * slope * per_mass) / two_pi});
    };
    add("small waves pass up to", "acoustic_band_to_hz", 1 / heavy);
    add("and again from", "optical_band_from_hz", 1 / light);
    add("to", "optical_band_to_hz", 1 / light + 1 / heavy);
}

void add_spheres(Report& report, const Scene& scene, const Chain& chain) {
    const SphereRow row(scene);
    const bool several = row.size() > 1;
    const auto spheres = chain.inv_mass.head(row.size());
    const auto between = [&](Eigen::Index contact) {
        return tangent_stiffness(chain.stiffness[contact], chain.static_overlap[contact]);
    };
    double length = 0;
    double mass = 0;
    double compliance = 0;
    for (Eigen::Index c = 1; c < row.size(); ++c) {
        length += chain.radius[c - 1] + chain.radius[c];
        mass += (1 / chain.inv_mass[c - 1] + 1 / chain.inv_mass[c]) / 2;
        compliance += 1 / between(c);
    }
    report.push_back(
        {"spheres", "mass", "sphere_mass_kg", "kg", if_any(row.uniform(), 1 / chain.inv_mass[0])});
    if (!row.uniform()) {
        report.push_back(
            {"spheres", "mass of the lightest", "lightest_sphere_kg", "kg", 1 / spheres.maxCoeff()});
        report.push_back(
            {"spheres", "mass of the heaviest", "heaviest_sphere_kg", "kg", 1 / spheres.minCoeff()});
    }
    report.push_back({"spheres", "wave speed, long small waves", "wave_speed_m_per_s", "m/s",
                      if_any(several, length / std::sqrt(mass * compliance))});
    const bool equal_forces = scene.chain.gravity_m_per_s2 == 0;
    report.push_back({"spheres", "cut-off frequency, small waves", "cutoff_hz", "Hz",
                      if_any(several && row.uniform() && equal_forces,
                             several ? std::sqrt(4 * between(1) * chain.inv_mass[0]) / two_pi : 0)});
    if (row.period() == 2 && equal_forces) {
        add_bands(report, row, between(1));
    }
}

void add_contacts(Report& report, const Scene& scene, const Chain& chain,
                  const std::optional<Eigen::ArrayXd>& peaks) {
    struct Kind {
        const char* label;
        const char* name;
        Eigen::Index contact;
        bool exists;
    };
    if (scene.chain.damping_law != DampingLaw::dashpot) {
        report.push_back(
            {"contacts", "law of damping", "damping_law", "", std::string(word(scene.chain.damping_law))});
    }
    const auto exists = existing_contacts(scene);
    const std::array<Kind, contact_kinds> kinds{{{"horn - sphere", "horn", 0, exists[0]},
                                                 {"sphere - sphere", "sphere", 1, exists[1]},
                                                 {"sphere - end", "end", chain.spheres(), exists[2]}}};
    for (const Kind& kind : kinds) {
        report.push_back({"contacts", std::string(kind.label) + ", stiffness",
                          std::string(kind.name) + "_contact_stiffness_n_per_m1_5", "N/m^1.5",
                          if_any(kind.exists, chain.stiffness[kind.contact])});
    }
    for (const Kind& kind : kinds) {
        report.push_back({"contacts", std::string(kind.label) + ", static overlap",
                          std::string(kind.name) + "_contact_static_overlap_m", "m",
                          if_any(kind.exists, chain.static_overlap[kind.contact])});
    }
    const ContactLoad at_rest = contact_load(chain, chain.static_overlap);
    const JudgedContacts judged = judge_contacts(scene, chain, peaks ? *peaks : chain.static_overlap);
    for (std::size_t i = 0; i < kinds.size(); ++i) {
        const Kind& kind = kinds[i];
        const JudgedContact& contact = judged[i];
        const auto& limit = contact.limit;
        const auto add = [&](const char* label, const char* name, Value value) {
            report.push_back({"contacts", fmt::format("{}, {}", kind.label, label),
                              fmt::format("{}_contact_{}", kind.name, name), "Pa", std::move(value)});
        };
        add("pressure at rest", "static_pressure_pa", if_any(kind.exists, at_rest.pressures_pa[i]));
        add("peak pressure", "peak_pressure_pa", if_any(kind.exists && peaks, contact.pressure_pa));
        add("its limit", "pressure_limit_pa", if_any(kind.exists && limit, limit ? limit->pressure_pa : 0));
    }
}

/// Adds the rows of a plate with modes in its fluid, and the errors of its poles.
void add_modal_plate(Report& report, const PlateResponse& plate, const Scene& scene) {
    report.push_back({"modes", "theory of plates", "plate_theory", "", std::string(word(scene.end.theory))});
    for (std::size_t n = 0; n < plate.modes.size(); ++n) {
        const PlateMode& mode = plate.modes[n];
        const auto add = [&](const char* label, const char* key, const char* unit, double value) {
            report.push_back({"modes", fmt::format("mode {}, {}", n + 1, label),
                              fmt::format("mode_{}_{}", n + 1, key), unit, value});
        };
        add("in a vacuum", "dry_hz", "Hz", mode.dry_hz);
        add("with the fluid's mass", "wet_hz", "Hz", mode.wet_hz);
        add("modal mass", "mass_kg", "kg", mode.mass_kg);
        add("k_b h", "kb_h", "", mode.kb_h);
    }
    const auto add = [&](const char* label, const char* key, const char* unit, Value value) {
        report.push_back({"fluid", label, key, unit, std::move(value)});
    };
    add("poles", "poles", "", scene.numerics.poles.value_or(0));
    add("fitted up to", "fit_band_hz", "Hz", plate.band_hz);
    add("error of the velocity's fit", "fit_velocity_error", "", plate.velocity_error);
    add("error of the pressure's fit", "fit_pressure_error", "", plate.pressure_error);
    add("least resistance over mobility", "fit_least_resistance", "", plate.least_resistance);
    add("travel time to the hydrophone", "travel_s", "s", plate.parameters.travel_s());
}

/// Adds the rows of a disc with layers, which bends as one plate.
void add_layers(Report& report, const Scene& scene) {
    if (scene.end.kind != EndKind::plate || scene.end.materials.empty()) {
        return;
    }
    const Laminate disc = laminate(layers_of(scene));
    const auto add = [&](const char* label, const char* key, const char* unit, double value) {
        report.push_back({"layers", label, key, unit, value});
    };
    add("bending stiffness D*", "laminate_bending_n_m", "N m", disc.section.bending_n_m);
    add("mass per area", "laminate_mass_kg_per_m2", "kg/m^2", disc.section.mass_kg_per_m2);
    add("loss factor", "laminate_loss_factor", "", disc.section.loss_factor);
    add("neutral plane, from the sphere's side", "laminate_neutral_plane_m", "m", disc.neutral_plane_m);
    add("shear stiffness over 5/6 sum G h", "laminate_shear_ratio", "", disc.shear_ratio);
}

void add_end(Report& report, const Scene& scene, const Chain& chain) {
    add_layers(report, scene);
    if (chain.end.plate) {
        add_modal_plate(report, *chain.end.plate, scene);
        return;
    }
    const bool plate = scene.end.kind == EndKind::plate;
    double mass = 0;
    double stiffness = 0;
    if (plate) {
        mass = plate_mass(scene);
        stiffness = plate_stiffness(scene);
    }
    report.push_back({"plate", "mass", "plate_mass_kg", "kg", if_any(plate, mass)});
    report.push_back(
        {"plate", "moving mass (a quarter)", "plate_moving_mass_kg", "kg", if_any(plate, mass / 4)});
    report.push_back({"plate", "stiffness", "plate_stiffness_n_per_m", "N/m", if_any(plate, stiffness)});
    report.push_back({"plate", "natural frequency, alone", "plate_frequency_hz", "Hz",
                      if_any(plate, std::sqrt(stiffness / (mass / 4)) / two_pi)});
    report.push_back(
        {"plate", "transmission sqrt(Tm Tw)", "transmission", "", if_any(plate, chain.end.transmission)});
}

/// Numbers of a recorded drive and of the low-pass that it goes through.
void add_record(Report& report, const Drive& drive) {
    if (!has_samples(drive)) {
        return;
    }
    const RecordFacts& record = SampledMotion::of(drive)->facts();
    const DriveQuantity quantity = recorded_quantity(drive);
    const bool velocity = quantity == DriveQuantity::velocity;
    const char* const unit = velocity ? "m/s" : "m";
    const std::string suffix = velocity ? "_m_per_s" : "_m";
    report.push_back({"record", "samples", "record_samples", "", record.samples});
    report.push_back({"record", "sample rate", "record_sample_rate_hz", "Hz", *drive.sample_rate_hz});
    report.push_back({"record", "duration", "record_duration_s", "s", record.duration_s});
    report.push_back({"record", "quantity", "record_quantity", "", std::string(word(quantity))});
    report.push_back(
        {"record", "strongest line, or as set", "record_frequency_hz", "Hz", drive.frequency_hz});
    report.push_back(
        {"record", "largest displacement", "record_displacement_m", "m", record.largest_displacement_m});
    report.push_back(
        {"record", "largest velocity", "record_velocity_m_per_s", "m/s", record.largest_velocity});
    report.push_back({"record", "low-pass keeps, up to", "record_lowpass_hz", "Hz", lowpass_hz(drive)});
    report.push_back(
        {"record", "rms removed, over rms of the rest", "record_beyond_ratio", "", record.beyond_share});
    report.push_back({"record", "noise floor, rms, at most", "record_noise" + suffix, unit, record.noise});
    report.push_back({"record", "its velocity that is kept, rms", "record_noise_velocity_m_per_s", "m/s",
                      record.noise_velocity});
    report.push_back({"record", "offset (first sample)", "record_offset" + suffix, unit, record.offset});
    report.push_back(
        {"record", "drift (mean velocity)", "record_drift_m_per_s", "m/s", record.drift_m_per_s + 0.0});
    report.push_back({"record", "drift removed", "record_drift_removed", "", record.drift_removed});
}

/// Adds the rows of a live drive: its rate, low-pass and latency.
void add_live_drive(Report& report, const Scene& scene) {
    const Drive& drive = scene.drive;
    if (drive.kind != DriveKind::live) {
        return;
    }
    const double rate = scene.output.sample_rate_hz;
    report.push_back(
        {"drive", "sample rate", "drive_sample_rate_hz", "Hz", drive.sample_rate_hz.value_or(rate)});
    report.push_back({"drive", "low-pass keeps, up to", "drive_lowpass_hz", "Hz", lowpass_hz(drive)});
    report.push_back({"drive", "latency", "latency_s", "s", drive.start_s});
    report.push_back({"drive", "in samples of the output", "latency_samples", "",
                      static_cast<std::int64_t>(std::llround(drive.start_s * rate))});
}

void add_time_scales(Report& report, const Scene& scene, const Chain& chain,
                     const std::optional<Eigen::ArrayXd>& peaks) {
    const bool horn = scene.drive.kind != DriveKind::none;
    report.push_back({"time", "duration of a burst", "burst_duration_s", "s",
                      if_any(horn, horn ? burst_duration_s(scene.drive) : 0)});
    report.push_back({"time", "fastest mode at rest", "fastest_static_hz", "Hz",
                      fastest_frequency(chain, chain.static_overlap) / two_pi});
    report.push_back({"time", "fastest mode in motion", "fastest_dynamic_hz", "Hz",
                      if_any(peaks.has_value(), peaks ? fastest_frequency(chain, *peaks) / two_pi : 0)});
}

void add_accuracy(Report& report, const Resolution& resolved) {
    const StepAdvice& advice = resolved.advice;
    const ErrorEstimate estimate = resolved.estimate.value_or(ErrorEstimate{});
    const bool known = resolved.estimate.has_value();
    report.push_back({"accuracy", "requested relative error", "wanted_accuracy", "", advice.accuracy});
    report.push_back(
        {"accuracy", "estimated with this step", "estimated_error", "", if_any(known, estimate.error)});
    report.push_back(
        {"accuracy", "estimated over the first", "estimated_over_s", "s", if_any(known, estimate.over_s)});
    report.push_back({"accuracy", "request can be met", "accuracy_met", "",
                      advice.accuracy_met && !resolved.misses_accuracy() &&
                          (!known || estimate.error <= advice.accuracy)});
    report.push_back({"accuracy", "pilot runs", "pilots", "", static_cast<std::int64_t>(resolved.pilots)});
    report.push_back(
        {"accuracy", "pilots choose the step over", "pilot_duration_s", "s", advice.pilot_duration_s});
}

std::string reason_text(IntegratorReason reason) {
    switch (reason) {
        case IntegratorReason::set_by_scene:
            return "set by the scene";
        case IntegratorReason::fastest:
            return "fastest at this accuracy: series of order 8";
        case IntegratorReason::high_accuracy:
            return fmt::format("accuracy below {:g}: series of order 12", high_accuracy);
    }
    return {};
}

void add_step(Report& report, const Resolution& resolved) {
    const Scene& scene = resolved.scene;
    const StepAdvice& advice = resolved.advice;
    const double step = *scene.numerics.step_s;
    const bool series = is_series(*scene.numerics.integrator);
    report.push_back({"step", "integrator", "integrator", "", std::string(word(*scene.numerics.integrator))});
    report.push_back({"step", "reason", "integrator_reason", "", reason_text(resolved.integrator_reason)});
    report.push_back({"step", "step", "step_s", "s", step});
    report.push_back(
        {"step", "kind of step", "step_role", "", std::string(series ? "longest piece" : "step")});
    report.push_back({"step", "chosen by", "step_chosen_by", "",
                      std::string(resolved.step_set_by_scene ? "scene" : "accuracy")});
    report.push_back({"step", series ? "pieces per burst, about" : "steps per burst, about",
                      "steps_per_burst", "", report_count(resolved.steps_per_burst)});
    report.push_back(
        {"step", "steps per sample", "steps_per_sample", "", 1 / (scene.output.sample_rate_hz * step)});
    report.push_back({"step", "recommended step", "recommended_step_s", "s", advice.recommended_step_s});
    report.push_back({"step", "estimated error of that step", "recommended_step_estimated_error", "",
                      advice.estimated_error});
    if (advice.largest_stable_step_s > 0) {  // not measured of an array
        report.push_back(
            {"step", "largest stable step", "largest_stable_step_s", "s", advice.largest_stable_step_s});
    }
}

}  // namespace

double first_burst_s(const Scene& scene) {
    return 1.5 * first_burst_end_s(as_declared(scene));
}

std::optional<PeakOverlaps> peak_overlaps(const Scene& scene, double duration_s) {
    constexpr double max_body_steps = 3e7;
    const double bodies = static_cast<double>(scene.chain.spheres) * static_cast<double>(chains_of(scene));
    if (duration_s / *scene.numerics.step_s * bodies > max_body_steps) {
        return std::nullopt;
    }
    Scene watched = as_declared(scene);
    constexpr double least_samples = 1000;  // else its last sample may lie far before the end
    double& rate_hz = watched.output.sample_rate_hz;
    rate_hz = std::max(rate_hz, least_samples / duration_s);
    const auto samples = static_cast<std::int64_t>(std::ceil(duration_s * rate_hz));
    Simulation simulation(std::move(watched));
    if (simulation.skip(samples) != Status::running) {
        return std::nullopt;
    }
    PeakOverlaps peaks;
    for (std::size_t element = 0; element < simulation.elements(); ++element) {
        peaks.push_back(simulation.state(element).peak_overlap);
    }
    return peaks;
}

std::vector<std::string> contact_warnings(const Scene& scene, const std::optional<PeakOverlaps>& peaks) {
    Run run;
    for (std::size_t element = 0; element < chains_of(scene); ++element) {
        const Scene one = element_scene(scene, element);
        const Chain chain(one);
        add_contacts(run, one, chain, peaks ? (*peaks)[element] : chain.static_overlap);
    }
    std::vector<std::string> warnings;
    if (peaks) {  // overlaps at rest are checked with the scene
        warnings = validity_warnings(run.load);
    }
    if (run.strength_warning) {
        warnings.push_back(*run.strength_warning);
    }
    return warnings;
}

std::vector<std::string> check_warnings(const Scene& scene, const std::optional<PeakOverlaps>& peaks) {
    std::vector<std::string> warnings = contact_warnings(scene, peaks);
    if (auto late = late_wave_warning(scene)) {
        warnings.push_back(*std::move(late));
    }
    std::ranges::move(late_sound_warnings(scene), std::back_inserter(warnings));
    return warnings;
}

std::vector<ReportRow> scene_report(const Resolution& resolved, const std::optional<PeakOverlaps>& peaks) {
    const Scene& scene = resolved.scene;
    const Scene first = element_scene(scene, 0);
    const Chain chain(first);
    const std::optional<Eigen::ArrayXd> first_peaks = peaks ? std::optional(peaks->front()) : std::nullopt;
    Report report;
    add_spheres(report, first, chain);
    add_contacts(report, first, chain, first_peaks);
    add_end(report, scene, chain);
    add_record(report, scene.drive);
    add_live_drive(report, scene);
    add_time_scales(report, scene, chain, first_peaks);
    add_accuracy(report, resolved);
    add_step(report, resolved);
    return report;
}

Value report_count(double number) {
    constexpr double most = 9e18;
    return number < most ? Value(static_cast<std::int64_t>(std::llround(number))) : Value(number);
}

Json report_json(std::span<const ReportRow> report) {
    const auto converted = []<class T>(const T& value) -> Json {
        if constexpr (std::is_same_v<T, std::monostate>) {
            return nullptr;
        } else {
            return value;
        }
    };
    Json json;
    for (const ReportRow& row : report) {
        json[row.name] = std::visit(converted, row.value);
    }
    return json;
}

}  // namespace hertzline::measures
