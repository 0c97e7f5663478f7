#include "core/model/drive.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/model/horn.hpp"
#include "core/model/reconstruction.hpp"
#include "core/model/sampled_motion.hpp"
#include "core/model/tone_burst.hpp"
#include "core/scene/elements.hpp"
#include "core/scene/latest_results.hpp"
#include "core/scene/text.hpp"
#include "hertzline/taps.hpp"

namespace hertzline {

DriveQuantity recorded_quantity(const Drive& drive) noexcept {
    return drive.quantity.value_or(DriveQuantity::displacement);
}

double burst_duration_s(const Drive& drive) {
    return has_samples(drive) ? SampledMotion::of(drive)->facts().duration_s
                              : drive.cycles / drive.frequency_hz;
}

double first_burst_end_s(const Scene& scene) {
    return scene.drive.start_s + std::ranges::max(element_delays_s(scene)) + burst_duration_s(scene.drive);
}

double highest_frequency_hz(const Drive& drive) {
    return drive.kind == DriveKind::file ? SampledMotion::of(drive)->facts().mean_frequency_hz
                                         : std::max(drive.frequency_hz, drive.sweep_to_hz.value_or(0));
}

namespace {

/// tip_peak() for an amplitude of 1 m: of u'' + decay u' + square u = square gain x, by Runge and Kutta's method.
HornMotion unit_tip_peak(const Drive& drive) {
    const HornResonator horn = *horn_resonator(drive);
    constexpr double steps_in_period = 64;  // errors of 1e-5
    const double fastest_hz =
        std::max(highest_frequency_hz(drive), std::sqrt(horn.square) / (2 * std::numbers::pi));
    const double h = 1 / (steps_in_period * fastest_hz);
    const ToneBurst tone(drive, h);
    const auto steps = static_cast<std::int64_t>(std::ceil(burst_duration_s(drive) / h));
    HornMotion peak;
    double u = 0;
    double v = 0;
    for (std::int64_t step = 0; step < steps; ++step) {
        const auto force = [&](double fraction) { return horn.gain * tone.at(step, fraction).x; };
        const auto acceleration = [&](double drawn, double at, double speed) {
            return horn.square * (drawn - at) - horn.decay * speed;
        };
        const std::array drawn{force(0), force(0.5), force(1)};
        const double a1 = acceleration(drawn[0], u, v);
        const double v2 = v + h / 2 * a1;
        const double a2 = acceleration(drawn[1], u + h / 2 * v, v2);
        const double v3 = v + h / 2 * a2;
        const double a3 = acceleration(drawn[1], u + h / 2 * v2, v3);
        const double v4 = v + h * a3;
        const double a4 = acceleration(drawn[2], u + h * v3, v4);
        u += h / 6 * (v + 2 * v2 + 2 * v3 + v4);
        v += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
        peak.x = std::max(peak.x, std::abs(u));
        peak.v = std::max(peak.v, std::abs(v));
    }
    return peak;
}

}  // namespace

std::optional<HornMotion> tip_peak(const Drive& drive) {
    constexpr double most_periods = 1e4;
    if (drive.kind != DriveKind::tone || drive.horn != HornModel::resonator || drive.amplitude_m == 0 ||
        burst_duration_s(drive) * std::max(highest_frequency_hz(drive), drive.horn_frequency_hz.value_or(0)) >
            most_periods) {
        return std::nullopt;
    }
    Drive unit = drive;
    unit.amplitude_m = 1;
    unit.start_s = 0;
    unit.repetition_hz = 0;
    constexpr std::size_t most = 8;  // a scene asks for its own several times
    static LatestResults<Drive, HornMotion> kept(most);
    HornMotion peak = *kept.of(unit, [&] { return unit_tip_peak(unit); });
    peak.x *= drive.amplitude_m;
    peak.v *= drive.amplitude_m;
    return peak;
}

double largest_velocity(const Drive& drive) {
    switch (drive.kind) {
        case DriveKind::none:
            return 0;
        case DriveKind::file:
            return SampledMotion::of(drive)->facts().largest_velocity;
        case DriveKind::tone:
        case DriveKind::live:
            break;
    }
    const double nominal = 2 * std::numbers::pi * highest_frequency_hz(drive) * drive.amplitude_m;
    const auto peak = tip_peak(drive);
    return peak ? std::max(nominal, peak->v) : nominal;
}

std::optional<HornResonator> horn_resonator(const Drive& drive) {
    if (drive.kind == DriveKind::none || drive.horn == HornModel::prescribed) {
        return std::nullopt;
    }
    const double omega = 2 * std::numbers::pi * drive.horn_frequency_hz.value_or(drive.frequency_hz);
    const double ratio = 2 * std::numbers::pi * drive.frequency_hz / omega;
    return HornResonator{.square = omega * omega,
                         .decay = omega / drive.horn_quality,
                         .inv_mass = drive.horn_mass_kg > 0 ? 1 / drive.horn_mass_kg : 0,
                         // the amplitude is that of the free tip in the steady state
                         .gain = std::hypot(1 - ratio * ratio, ratio / drive.horn_quality),
                         .record = drive.kind == DriveKind::file || drive.kind == DriveKind::live};
}

bool has_samples(const Drive& drive) noexcept {
    return drive.kind == DriveKind::file || (drive.kind == DriveKind::live && !drive.samples.empty());
}

bool awaits_samples(const Drive& drive) noexcept {
    return drive.kind == DriveKind::live && drive.samples.empty() && !drive.file;
}

std::optional<Fault> awaited_samples_fault(const Drive& drive) {
    if (!awaits_samples(drive)) {
        return std::nullopt;
    }
    return Fault{"drive.kind", R"("live" without samples)",
                 "a stream (hertzline stream --drive ENDPOINT), or a recording of one"};
}

Scene as_declared(Scene scene) {
    if (scene.drive.kind == DriveKind::live) {
        scene.drive.kind = DriveKind::tone;
        scene.drive.start_s = 0;
        scene.drive.samples.clear();
        scene.drive.horn = HornModel::prescribed;  // samples are the tip's free motion, as the tone then is
    }
    return scene;
}

Scene with_live_drive(Scene scene) {
    Drive& drive = scene.drive;
    if (drive.kind != DriveKind::live) {
        return scene;
    }
    drive.sample_rate_hz = drive.sample_rate_hz.value_or(scene.output.sample_rate_hz);
    drive.repetition_hz = 0;
    if (!drive.quantity && drive.socket == DriveSocket::sub && drive.column) {
        const auto stream = std::ranges::find(tap_rows, *drive.column, &TapRow::name);
        const bool velocity = stream != tap_rows.end() && stream->unit == "m/s";
        drive.quantity = velocity ? DriveQuantity::velocity : DriveQuantity::displacement;
    }
    return scene;
}

double reach_beyond_sample_s(const Scene& scene) noexcept {
    const double step_s = scene.numerics.step_s.value_or(0);
    const double period_s = 1 / scene.output.sample_rate_hz;
    const bool series = is_series(scene.numerics.integrator.value_or(Integrator::taylor8));
    return Horn::batch_steps * std::max(period_s, series ? 0 : step_s) + step_s;
}

Scene with_latency(Scene scene) {
    Drive& drive = scene.drive;
    if (!awaits_samples(drive)) {
        return scene;
    }
    const double rate = *drive.sample_rate_hz;
    const auto lookahead = static_cast<double>(Reconstruction::lookahead(rate, lowpass_hz(drive)));
    const double ahead_s = (lookahead + 1) / rate + reach_beyond_sample_s(scene);
    const double samples = static_cast<double>(scene.output.frame_samples + 1) +
                           std::ceil(ahead_s * scene.output.sample_rate_hz);
    const double asked = std::ceil(drive.start_s * scene.output.sample_rate_hz - 1e-6);
    drive.start_s = std::max(samples, asked) / scene.output.sample_rate_hz;
    return scene;
}

namespace {

/// @param drive with its rate
std::optional<Fault> lowpass_fault(const Drive& drive) {
    const double rate = *drive.sample_rate_hz;
    const double lowpass = lowpass_hz(drive);
    if (lowpass <= rate / 3 && lowpass >= rate / 1e4) {
        return std::nullopt;
    }
    const double highest = rate > 3e3 ? std::floor(rate / 3) : rate / 3;
    return Fault{"drive.lowpass_hz", number_text(lowpass),
                 number_text(rate / 1e4) + " to " + number_text(highest) +
                     " Hz, a ten-thousandth to a third of the rate of the samples"};
}

/// Of a live drive whose samples come while a stream runs.
std::vector<Fault> live_faults(const Drive& drive) {
    auto fault = drive.sample_rate_hz ? lowpass_fault(drive) : std::nullopt;
    return fault ? std::vector{*std::move(fault)} : std::vector<Fault>{};
}

}  // namespace

std::vector<Fault> drive_faults(const Drive& drive) {
    if (drive.kind != DriveKind::file && drive.kind != DriveKind::live) {
        return {};
    }
    if (drive.kind == DriveKind::live && drive.samples.empty()) {
        return live_faults(drive);
    }
    if (drive.samples.empty()) {
        return {{"drive.file", drive.file ? quoted_briefly(*drive.file) + ", which was not read" : "nothing",
                 R"(a recording, or drive.samples, with drive.kind = "file")"}};
    }
    if (drive.samples.size() == 1) {
        return {{"drive.samples", "one sample", "at least two: a motion"}};
    }
    if (!drive.sample_rate_hz) {
        return {{"drive.sample_rate_hz", "nothing", "the rate of the record: its file does not tell it"}};
    }
    if (drive.file) {
        return {{"drive.file", quoted_briefly(*drive.file) + " beside drive.samples",
                 "one of them; the command that reads a scene reads its file, too"}};
    }
    if (drive.column) {
        return {{"drive.column", quoted_briefly(*drive.column),
                 "none beside drive.samples: a column of drive.file"}};
    }
    std::vector<Fault> faults;
    if (auto fault = lowpass_fault(drive)) {
        return {*std::move(fault)};
    }
    if (drive.kind == DriveKind::live) {
        return {};  // it was simulated as it came
    }
    const RecordFacts& record = SampledMotion::of(drive)->facts();
    constexpr double largest_start = 0.01;  // of the peak
    const auto percent = [](double share) { return number_text(std::round(1e3 * share) / 10) + " %"; };
    constexpr double seen_in_noise = 8;  // times its rms, which is larger at the edge: less is no motion
    const bool begins_in_motion =
        record.start_share > largest_start &&
        (record.beyond_share > 1 ||  // a low-pass that removes most of a record removes more than noise
         record.start_share * record.largest_velocity > seen_in_noise * record.noise_velocity);
    if (begins_in_motion && record.raw_start_share <= largest_start) {
        faults.push_back({"drive.lowpass_hz",
                          number_text(lowpass_hz(drive)) +
                              ", with which the motion begins before the record, at " +
                              percent(record.start_share) + " of its largest velocity at its first sample",
                          "a higher one, or a record with a longer rest before the motion"});
    } else if (begins_in_motion) {
        faults.push_back(
            {"drive.samples",
             "a record that begins amid a motion, at " + percent(record.start_share) +
                 " of its largest velocity",
             "one that begins at rest, with at most 1 %: cut it where the horn still rests, or fade it in"});
    }
    constexpr double farthest_m = 1;  // as drive.amplitude_m
    if (!(record.largest_displacement_m <= farthest_m)) {
        faults.push_back({"drive.samples",
                          "a largest displacement of " + number_text(record.largest_displacement_m) + " m",
                          "1 m at most; drive.scale is what one number of the record stands for"});
    }
    if (drive.repetition_hz > 0) {
        if (record.duration_s * drive.repetition_hz > 1 + 1e-12) {
            faults.push_back({"drive.repetition_hz", number_text(drive.repetition_hz),
                              "at most " + number_text(1 / record.duration_s) +
                                  " Hz, so that the records of " + number_text(record.duration_s) +
                                  " s do not overlap"});
        } else if (drive.start_s > 0 &&
                   (drive.start_s + record.duration_s) * drive.repetition_hz > 1 + 1e-12) {
            faults.push_back({"drive.start_s", number_text(drive.start_s),
                              "at most " + number_text(1 / drive.repetition_hz - record.duration_s) +
                                  " s: a record lies within its period"});
        } else if (record.end_displacement_m > largest_start * record.largest_displacement_m) {
            faults.push_back({"drive.repetition_hz", number_text(drive.repetition_hz),
                              "0, as the record ends " +
                                  percent(record.end_displacement_m / record.largest_displacement_m) +
                                  " of its largest displacement away from its beginning"});
        }
    }
    return faults;
}

}  // namespace hertzline
