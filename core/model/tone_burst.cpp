#include "core/model/tone_burst.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace hertzline {

namespace {

constexpr int waiting = -1;
constexpr int rise = 0;
constexpr int top = 1;
constexpr int fall = 2;
constexpr int silence = 3;
constexpr double smallest_piece = 1e-9;  // [steps]: a break closer to a step's end than this is at its end

/// Product of carrier s(t) and envelope e(t) with its derivatives. @param rate of change of the carrier's omega [rad/s^2]
HornMotion product(double amplitude, double omega, double rate, double s, double c, double e, double de,
                   double dde) noexcept {
    return {amplitude * (e * s), amplitude * (de * s + e * (omega * c)),
            amplitude * ((dde - omega * omega * e) * s + (2 * de * (omega * c) + e * (rate * c)))};
}

}  // namespace

ToneBurst::ToneBurst(const Drive& drive, double step_s)
    : clock_(step_s, drive.start_s, drive.kind == DriveKind::none ? 0 : drive.repetition_hz),
      amplitude_(drive.kind == DriveKind::none ? 0 : drive.amplitude_m),
      omega_(2 * std::numbers::pi * drive.frequency_hz),
      sweep_hz_per_s_(drive.sweep_to_hz
                          ? (*drive.sweep_to_hz - drive.frequency_hz) * drive.frequency_hz / drive.cycles
                          : 0),
      duration_(drive.cycles / drive.frequency_hz),
      hann_(drive.envelope == Envelope::hann) {
    if (hann_) {
        rise_ = duration_;
        ramp_omega_ = 2 * std::numbers::pi / duration_;
    } else if (drive.envelope == Envelope::tukey && drive.taper > 0) {
        rise_ = drive.taper * duration_ / 2;
        ramp_omega_ = std::numbers::pi / rise_;
    }
}

double ToneBurst::piece_end(int piece) const noexcept {
    switch (piece) {
        case waiting:
            return 0;
        case rise:
            return rise_;
        case top:
            return duration_ - rise_;
        case fall:
            return duration_;
        default:
            return clock_.period_s();
    }
}

ToneBurst::Place ToneBurst::place(std::int64_t step, double fraction) const noexcept {
    const std::int64_t burst = clock_.burst_at(step, fraction);
    const double local = clock_.since(step, fraction, burst);
    if (local < 0) {
        return {burst, waiting, local};
    }
    int piece = hann_ ? rise : (rise_ > 0 ? rise : top);
    while (piece < silence && local >= piece_end(piece)) {
        piece = hann_ ? silence : piece + 1;
    }
    return {burst, piece, local};
}

HornMotion ToneBurst::motion(int piece, double local) const noexcept {
    if (piece == silence || piece == waiting) {
        return {};
    }
    const double rate = 2 * std::numbers::pi * sweep_hz_per_s_;
    const double omega = omega_ + rate * local;
    const double angle = (omega_ + rate * local / 2) * local;
    const double s = std::sin(angle);
    const double c = std::cos(angle);
    if (piece == top) {
        return product(amplitude_, omega, rate, s, c, 1, 0, 0);
    }
    // (1 - cos)/2 is even: a fall is a rise that starts from minus its length
    const double ramp = ramp_omega_ * (piece == fall ? local - duration_ : local);
    const double half = std::sin(ramp / 2);  // (1 - cos)/2 without cancellation
    return product(amplitude_, omega, rate, s, c, half * half, 0.5 * ramp_omega_ * std::sin(ramp),
                   0.5 * ramp_omega_ * ramp_omega_ * std::cos(ramp));
}

HornMotion ToneBurst::at(std::int64_t step, double fraction, double on_piece) const noexcept {
    const Place where = place(step, on_piece);
    return motion(where.piece, clock_.since(step, fraction, where.burst));
}

double ToneBurst::next_break(std::int64_t step, double after) const noexcept {
    const double begin = after + smallest_piece;
    const Place where = place(step, begin);
    const double fraction = begin + (piece_end(where.piece) - where.local) / clock_.step_s();
    return fraction < 1 - smallest_piece ? fraction : 1;
}

std::array<double, 3> ToneBurst::frequencies_hz() const noexcept {
    const double carrier = omega_ / (2 * std::numbers::pi);
    const double ramp = ramp_omega_ / (2 * std::numbers::pi);
    return {carrier, carrier + ramp, carrier - ramp};
}

SmoothDrive ToneBurst::smooth(std::int64_t step, double fraction) const noexcept {
    const Place where = place(step, fraction + smallest_piece);
    SmoothDrive drive;
    drive.since_burst_s = clock_.since(step, fraction, where.burst);
    drive.left_s = piece_end(where.piece) - drive.since_burst_s;
    if (where.piece == top) {
        drive.amplitude_m = {amplitude_, 0, 0};
    } else if (where.piece != silence && where.piece != waiting) {
        // (1 - cos r)/2 sin c = sin(c)/2 - sin(c + r)/4 - sin(c - r)/4
        drive.amplitude_m = {amplitude_ / 2, -amplitude_ / 4, -amplitude_ / 4};
    }
    if (where.piece == fall) {
        const double late = duration_ * ramp_omega_ / (2 * std::numbers::pi);
        drive.phase_turns = {0, -late, late};
    }
    return drive;
}

/// Of a sweep: s' = c phi' and c' = -s phi' with an angle phi of degree 2.
void ToneBurst::series(const SmoothDrive& piece, double since_look_up, double unit_s,
                       std::span<double> terms) const noexcept {
    const double local = piece.since_burst_s + since_look_up;
    const std::array<double, 3> frequencies = frequencies_hz();
    std::ranges::fill(terms, 0.0);
    for (std::size_t i = 0; i < frequencies.size(); ++i) {
        if (piece.amplitude_m[i] == 0) {
            continue;
        }
        const double turns = (frequencies[i] + sweep_hz_per_s_ * local / 2) * local + piece.phase_turns[i];
        const double angle = 2 * std::numbers::pi * (turns - std::round(turns));
        const double first = 2 * std::numbers::pi * (frequencies[i] + sweep_hz_per_s_ * local) * unit_s;
        const double second = 2 * std::numbers::pi * sweep_hz_per_s_ * unit_s * unit_s;
        double sine = piece.amplitude_m[i] * std::sin(angle);
        double cosine = piece.amplitude_m[i] * std::cos(angle);
        double sine_before = 0;
        double cosine_before = 0;
        for (std::size_t n = 0; n < terms.size(); ++n) {
            terms[n] += sine;
            const double per = 1 / static_cast<double>(n + 1);
            const double next_sine = per * (first * cosine + second * cosine_before);
            const double next_cosine = -per * (first * sine + second * sine_before);
            sine_before = std::exchange(sine, next_sine);
            cosine_before = std::exchange(cosine, next_cosine);
        }
    }
}

void ToneBurst::fill_tables() noexcept {
    for (std::size_t j = 0; j < table_size; ++j) {
        const double offset = 0.5 * static_cast<double>(j) * clock_.step_s();
        carrier_cos_[j] = std::cos(omega_ * offset);
        carrier_sin_[j] = std::sin(omega_ * offset);
        ramp_cos_[j] = std::cos(ramp_omega_ * offset);
        ramp_sin_[j] = std::sin(ramp_omega_ * offset);
    }
    has_tables_ = true;
}

void ToneBurst::fill_smooth(const Place& start, HornStep* steps, int count) noexcept {
    if (!has_tables_) {
        fill_tables();
    }
    const double sin_carrier = std::sin(omega_ * start.local);
    const double cos_carrier = std::cos(omega_ * start.local);
    const bool on_top = start.piece == top;
    const double ramp = ramp_omega_ * (start.piece == fall ? start.local - duration_ : start.local);
    const double sin_ramp = on_top ? 0 : std::sin(ramp);
    const double cos_ramp = on_top ? -1 : std::cos(ramp);
    const double ramp_omega = on_top ? 0 : ramp_omega_;

    const auto node = [&](int j) {
        const double s = sin_carrier * carrier_cos_[j] + cos_carrier * carrier_sin_[j];
        const double c = cos_carrier * carrier_cos_[j] - sin_carrier * carrier_sin_[j];
        const double rs = on_top ? 0 : sin_ramp * ramp_cos_[j] + cos_ramp * ramp_sin_[j];
        const double rc = on_top ? -1 : cos_ramp * ramp_cos_[j] - sin_ramp * ramp_sin_[j];
        return product(amplitude_, omega_, 0, s, c, 0.5 * (1 - rc), 0.5 * ramp_omega * rs,
                       0.5 * ramp_omega * ramp_omega * rc * (on_top ? 0 : 1));
    };
    HornMotion from = node(0);
    for (int i = 0; i < count; ++i) {
        steps[i].start = from;
        steps[i].middle = node(2 * i + 1);
        from = node(2 * i + 2);
        steps[i].end = from;
        steps[i].fresh = false;
        steps[i].breaks = false;
    }
}

void ToneBurst::fill_piecewise(std::int64_t first, HornStep* steps, int count) const noexcept {
    for (int i = 0; i < count; ++i) {
        const std::int64_t step = first + i;
        HornStep& horn = steps[i];
        horn.start = at(step, 0, 0.5);
        horn.middle = at(step, 0.5, 0.5);
        horn.end = at(step, 1, 0.5);
        horn.breaks = next_break(step, 0) < 1;
        horn.fresh = horn.breaks || step == 0 || !(place(step, 0.5) == place(step - 1, 0.5));
    }
}

bool ToneBurst::fill(std::int64_t first, HornStep* steps, int count) noexcept {
    const Place before = place(first, -0.5);
    const Place begin = place(first, 0);
    const Place last = place(first + count - 1, 1);
    if (first > 0 && before == begin && begin == last) {
        if (begin.piece == silence || begin.piece == waiting) {
            std::fill_n(steps, count, HornStep{});
            return true;
        }
        if (sweep_hz_per_s_ != 0) {
            fill_piecewise(first, steps, count);
            return false;
        }
        fill_smooth(begin, steps, count);
        return false;
    }
    constexpr int few = 4;
    if (count > few) {
        const int half = count / 2;
        const bool still = fill(first, steps, half);
        return fill(first + half, steps + half, count - half) && still;
    }
    fill_piecewise(first, steps, count);
    return amplitude_ == 0;
}

}  // namespace hertzline
