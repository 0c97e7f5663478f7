#include "core/solvers/horn_series.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <utility>

#include "core/plate/quadrature.hpp"

namespace hertzline {

namespace {

constexpr std::int64_t turned_pieces = 64;  // until the horn's waves are computed again

}  // namespace

HornSeries::HornSeries(const Drive& drive, double sample_period_s,
                       std::shared_ptr<const PiecewiseMotion> live)
    : sample_period_s_(sample_period_s),
      horn_(make_horn(drive, sample_period_s, std::move(live))),
      frequencies_hz_(horn_->frequencies_hz()),
      resonator_(horn_resonator(drive)) {}

/// Those of a sweep are judged by its highest frequency, and the solver expands them.
kernels::HornWaves HornSeries::waves(const Drive& drive, double unit_s) const {
    std::array<double, 3> frequencies_hz = frequencies_hz_;
    if (!horn_->has_series() && !resonator_) {
        return {frequencies_hz, unit_s};
    }
    for (double& frequency : frequencies_hz) {
        frequency += drive.sweep_to_hz ? highest_frequency_hz(drive) - drive.frequency_hz : 0;
    }
    kernels::HornWaves waves(frequencies_hz, unit_s);
    waves.expanded = true;
    waves.turns = false;
    return waves;
}

void HornSeries::move(kernels::SeriesPiece& piece) noexcept {
    piece_ = &piece;
    if (resonator_) {
        tip_.square = resonator_->square * piece.unit_s * piece.unit_s;
        tip_.decay = resonator_->decay * piece.unit_s;
        tip_.inv_mass = resonator_->inv_mass;
        piece.tip = &tip_;
    }
}

void HornSeries::reset() noexcept {
    smooth_ = horn_->smooth(0, 0);
    smooth_from_ = {};
    tip_motion_ = {};
    set(0);
}

std::optional<double> HornSeries::begin_piece(FixedTime begin, std::int64_t number) noexcept {
    if (resonator_) {
        tip_motion_ = piece_->own_tip_at(piece_->length);
    }
    if (left_s(begin) < sliver * sample_period_s_) {
        const double before = displacement();
        smooth_ = horn_->smooth(begin.whole, begin.fraction());
        smooth_from_ = begin;
        set(0);
        return before;
    }
    if (!piece_->waves.turns || number % turned_pieces == 0) {
        set(difference(begin, smooth_from_) * sample_period_s_);
    }
    return std::nullopt;
}

double HornSeries::left_s(FixedTime begin) const noexcept {
    return smooth_.left_s - difference(begin, smooth_from_) * sample_period_s_;
}

void HornSeries::continue_from(double tip_m, double tip_m_per_s) noexcept {
    if (resonator_) {
        // its own motion is the difference from the free motion of the new drive
        tip_motion_ = {
            .x = tip_m - piece_->horn[0], .v = tip_m_per_s - piece_->horn[1] * piece_->per_unit, .a = 0};
        set(0);
    }
}

/// The horn's waves as they are some time [s] after the smooth piece was looked up, to the last digit.
void HornSeries::set(double since_look_up) noexcept {
    kernels::HornWaves& waves = piece_->waves;
    waves.silent = smooth_.silent() && !resonator_;
    waves.displacement = waves.slope = 0;
    if (waves.silent) {
        piece_->horn.fill(0);
    }
    waves.reach = 1;
    for (std::size_t i = 0; i < frequencies_hz_.size(); ++i) {
        if (smooth_.amplitude_m[i] != 0) {
            waves.reach = std::min(waves.reach, waves.reach_of_each[i]);
        }
    }
    if (waves.expanded) {
        // some terms more than the piece has: then the horn's motion at its end is exact enough for the ledger
        const std::size_t terms = resonator_ || piece_->degree() > 9 ? piece_->horn.size() : 12;
        horn_->series(smooth_, since_look_up, piece_->unit_s, std::span(piece_->horn).first(terms));
        if (resonator_) {
            begin_tip();
        }
        waves.displacement = piece_->horn[0];
        waves.slope = piece_->horn[1];
        return;
    }
    const double local = smooth_.since_burst_s + since_look_up;
    for (std::size_t i = 0; i < frequencies_hz_.size(); ++i) {
        const double turns = frequencies_hz_[i] * local + smooth_.phase_turns[i];
        const double angle = 2 * std::numbers::pi * (turns - std::round(turns));
        waves.sine[i] = smooth_.amplitude_m[i] * std::sin(angle);
        waves.cosine[i] = smooth_.amplitude_m[i] * std::cos(angle);
        waves.displacement += waves.sine[i];
        waves.slope += waves.cosine[i] * waves.odd[i][0];
    }
}

/// Begins the tip's series: of a record, which is its free motion, or of a tone, which drives it.
void HornSeries::begin_tip() noexcept {
    tip_.onset = {};
    tip_.own.fill(0);
    tip_.own[0] = tip_motion_.x;
    tip_.own[1] = tip_motion_.v * piece_->unit_s;
    tip_.forcing.fill(0);
    if (resonator_->record) {
        piece_->horn[0] += tip_.own[0];
        piece_->horn[1] += tip_.own[1];
        return;
    }
    for (std::size_t n = 0; n < piece_->horn.size(); ++n) {
        tip_.forcing[n] = resonator_->gain * piece_->horn[n];
    }
    piece_->horn = tip_.own;
}

/// Source, losses and energy of a horn that has a mass, over the piece.
void HornSeries::add_energy(Ledger& ledger) const noexcept {
    constexpr std::size_t nodes = 9;
    const double mass = 1 / resonator_->inv_mass;
    const double per_unit = piece_->per_unit;
    const bool record = resonator_->record;
    // r of a record is that of its free motion, the tip's without its own
    kernels::HornTip::Terms free = piece_->horn;
    for (std::size_t n = 0; n < free.size(); ++n) {
        free[n] = record ? free[n] - tip_.own[n] : tip_.forcing[n];
    }
    const auto r_at = [&](double z) {
        double x = 0;
        double v = 0;
        double a = 0;
        for (std::size_t n = free.size(); n-- > 0;) {
            a = a * z + 2 * v;
            v = v * z + x;
            x = x * z + free[n];
        }
        return record ? x + per_unit * (v * resonator_->decay + a * per_unit) / resonator_->square : x;
    };
    const double per_mass = mass * piece_->unit_s;
    each_node<nodes>(0, piece_->length, [&](double z, double weight) {
        const double v = piece_->tip_at(z).v;
        ledger.source_work += per_mass * weight * resonator_->square * r_at(z) * v;
        ledger.horn_lost += per_mass * weight * resonator_->decay * v * v;
    });
    const HornMotion now = piece_->tip_at(piece_->length);
    ledger.horn_held = mass / 2 * (now.v * now.v + resonator_->square * now.x * now.x);
}

double HornSeries::displacement() const noexcept {
    if (resonator_) {
        return piece_->tip_at(piece_->length).x;
    }
    if (piece_->waves.turns) {
        return piece_->waves.displacement;  // the kernels have moved it on to the piece's end
    }
    double horn = 0;
    for (std::size_t n = piece_->horn.size(); n-- > 0;) {
        horn = horn * piece_->length + piece_->horn[n];
    }
    return horn;
}

double HornSeries::velocity() const noexcept {
    if (resonator_) {
        return piece_->tip_at(piece_->length).v;
    }
    if (piece_->waves.turns) {
        return piece_->waves.slope * piece_->per_unit;
    }
    double slope = 0;
    for (std::size_t n = piece_->horn.size(); n-- > 1;) {
        slope = slope * piece_->length + static_cast<double>(n) * piece_->horn[n];
    }
    return slope * piece_->per_unit;
}

}  // namespace hertzline
