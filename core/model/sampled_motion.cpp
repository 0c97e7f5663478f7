#include "core/model/sampled_motion.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <vector>

#include "core/model/drive.hpp"
#include "core/model/reconstruction.hpp"
#include "core/scene/latest_results.hpp"

namespace hertzline {

namespace {

using std::numbers::pi;

/// Whether the record drifts: the first and the last twentieth of it have about the velocity that it has on average.
bool drifts(double mean, double first, double last) noexcept {
    return std::abs(first - mean) < std::abs(mean) / 2 && std::abs(last - mean) < std::abs(mean) / 2;
}

double mean_of(std::span<const double> values) noexcept {
    double sum = 0;
    for (const double value : values) {
        sum += value;
    }
    return values.empty() ? 0 : sum / static_cast<double>(values.size());
}

/// The record's samples in m or m/s, without offset and drift, which are noted. A live drive keeps its drift, as it did when it came.
std::vector<double> levelled(const Drive& drive, double rate, RecordFacts& facts) {
    std::vector<double> samples = drive.samples;
    for (double& sample : samples) {
        sample *= drive.scale.value_or(1);
    }
    const std::size_t count = samples.size();
    const std::size_t part = count / 20;
    const bool may_drift = part > 0 && drive.kind != DriveKind::live;
    facts.offset = samples.front();
    if (recorded_quantity(drive) == DriveQuantity::velocity) {
        facts.drift_m_per_s = mean_of(samples);
        const std::span<const double> all(samples);
        facts.drift_removed =
            may_drift && drifts(facts.drift_m_per_s, mean_of(all.first(part)), mean_of(all.last(part)));
        for (double& sample : samples) {
            sample -= facts.drift_removed ? facts.drift_m_per_s : 0;
        }
        return samples;
    }
    const double per_sample =
        count > 1 ? (samples.back() - samples.front()) / static_cast<double>(count - 1) : 0;
    facts.drift_m_per_s = per_sample * rate;
    const double parts = static_cast<double>(std::max<std::size_t>(part, 1));
    facts.drift_removed = may_drift && drifts(per_sample, (samples[part] - samples[0]) / parts,
                                              (samples[count - 1] - samples[count - 1 - part]) / parts);
    for (std::size_t i = 0; i < count; ++i) {
        samples[i] -= facts.offset + (facts.drift_removed ? per_sample * static_cast<double>(i) : 0);
    }
    return samples;
}

/// The noise, if all that the low-pass takes is white noise; the low-pass is taken to end where it leaves half.
void note_noise(const Reconstruction& record, double rate, DriveQuantity quantity, RecordFacts& facts) {
    const double middle = record.lowpass().middle_hz();
    const double density = record.taken() / (rate / 2 - middle);
    facts.beyond_share = record.kept() > 0 ? std::sqrt(record.taken() / record.kept()) : 0;
    facts.noise = std::sqrt(density * rate / 2);
    facts.noise_velocity = std::sqrt(density * middle);
    if (quantity == DriveQuantity::displacement) {
        facts.noise_velocity *= 2 * pi * middle / std::sqrt(3);
    }
}

}  // namespace

double lowpass_hz(const Drive& drive) noexcept {
    constexpr double usual_hz = 1e6;
    return drive.lowpass_hz.value_or(std::min(usual_hz, drive.sample_rate_hz.value_or(0) / 3));
}

SampledMotion::SampledMotion(const Drive& drive) {
    if (drive.samples.empty() || !drive.sample_rate_hz) {
        throw std::invalid_argument("the drive's record was not read, or its rate is not known");
    }
    const double rate = *drive.sample_rate_hz;
    const double edge = lowpass_hz(drive);
    const DriveQuantity quantity = recorded_quantity(drive);
    const std::vector<double> record = levelled(drive, rate, facts_);
    facts_.samples = static_cast<std::int64_t>(record.size());
    facts_.duration_s = static_cast<double>(record.size() - 1) / rate;
    Reconstruction reconstruction(rate, edge, quantity);
    reconstruction.expect(facts_.samples);
    reconstruction.append(record, pieces_);
    reconstruction.finish(pieces_);
    note_noise(reconstruction, rate, quantity, facts_);
    note_motion(edge);
    const double first = quantity == DriveQuantity::velocity ? record[0] : (record[1] - record[0]) * rate;
    double largest = facts_.largest_velocity;  // a low-pass may leave far less
    for (std::size_t i = 1; i < record.size(); ++i) {
        largest = std::max(
            largest,
            std::abs(quantity == DriveQuantity::velocity ? record[i] : (record[i] - record[i - 1]) * rate));
    }
    facts_.raw_start_share = largest > 0 ? std::abs(first) / largest : 0;
}

/// Displacements, velocities and frequencies of the pieces. @param edge of the low-pass [Hz]
void SampledMotion::note_motion(double edge) {
    double squares_of_v = 0;
    double squares_of_a = 0;
    for (const Polynomial& piece : std::span(pieces_).first(pieces_.size() - 1)) {
        constexpr int points = 8;
        for (int i = 0; i < points; ++i) {
            const HornMotion now = piece.at(piece.middle_s + piece.half_s * ((2 * i + 1.0) / points - 1));
            facts_.largest_displacement_m = std::max(facts_.largest_displacement_m, std::abs(now.x));
            facts_.largest_velocity = std::max(facts_.largest_velocity, std::abs(now.v));
            squares_of_v += piece.half_s * now.v * now.v;
            squares_of_a += piece.half_s * now.a * now.a;
        }
    }
    facts_.mean_frequency_hz = squares_of_a > 0 ? std::sqrt(squares_of_a / squares_of_v) / (2 * pi) : edge;
    facts_.end_displacement_m = std::abs(pieces_.back().terms[0]);
    if (facts_.largest_velocity > 0) {
        facts_.start_share = std::abs(pieces_.front().at(0).v) / facts_.largest_velocity;
        constexpr int points = 16;
        for (int i = 0; i <= points; ++i) {  // over the last period of the low-pass
            const double time = std::max(0.0, facts_.duration_s - i / (points * edge));
            const HornMotion now = at(time).at(time);
            facts_.end_share = std::max(facts_.end_share, std::abs(now.v) / facts_.largest_velocity);
        }
    }
}

const Polynomial& SampledMotion::at(double time_s) const noexcept {
    return *std::ranges::upper_bound(pieces_, time_s, {}, &Polynomial::end_s);
}

namespace {

/// All that a motion depends on.
struct MotionKey {
    DriveKind kind;
    std::optional<DriveQuantity> quantity;
    std::optional<double> sample_rate_hz, scale, lowpass_hz;
    std::vector<double> samples;
    bool operator==(const MotionKey&) const = default;
};

}  // namespace

std::shared_ptr<const SampledMotion> SampledMotion::of(const Drive& drive) {
    constexpr std::size_t most = 8;  // a scene asks for its own several times
    static LatestResults<MotionKey, SampledMotion> kept(most);
    return kept.of(
        {drive.kind, drive.quantity, drive.sample_rate_hz, drive.scale, drive.lowpass_hz, drive.samples},
        [&] { return SampledMotion(drive); });
}

}  // namespace hertzline
