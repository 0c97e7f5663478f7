#include "core/solvers/sampling/pressure_grid.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace hertzline {

PressureGrid::PressureGrid(const PlateResponse& response, const kernels::PlateMotion& plate,
                           const kernels::SeriesPiece& piece, const kernels::SeriesKernels& kernels,
                           double sample_period_s, const std::vector<SoundAtPoint>& sounds,
                           std::int64_t intervals_per_sample)
    : plate_(plate),
      piece_(piece),
      kernels_(kernels),
      sample_period_s_(sample_period_s),
      intervals_per_sample_(intervals_per_sample),
      forced_(response, sample_period_s / static_cast<double>(intervals_per_sample)) {
    const PlateParameters& p = response.parameters;
    const double unit_s = p.radius_m / p.fluid.sound_speed_m_per_s;
    const double interval_s = sample_period_s / static_cast<double>(intervals_per_sample);
    const auto first_of = [](const SoundAtPoint& at) { return at.sound.first(); };
    const double nearest = first_of(std::ranges::min(sounds, {}, first_of));
    first_delay_ = FixedTime::of(nearest * unit_s / sample_period_s_);
    for (const auto& [point, sound] : sounds) {
        const double later = (sound.first() - nearest) * unit_s / interval_s;
        const double whole = std::floor(later);
        const double share = 1 - (later - whole);
        pressures_.push_back({.point = point,
                              .kernel = ForceKernel(response, sound, interval_s, share),
                              .delay = static_cast<std::int64_t>(whole) + 1,
                              .share = share,
                              .ring = {}});
        Pressure& pressure = pressures_.back();
        kept_ = std::max(kept_, pressure.kernel.intervals + 1);
        const std::int64_t most = first_delay_.whole + pressure.delay / intervals_per_sample_ + 3;
        pressure.ring.resize(static_cast<std::size_t>(most) + EndTaps::max_count);
    }
    soonest_ = std::ranges::min(pressures_, {}, &Pressure::delay).delay;
    moments_.resize(2 * kept_);
    states_.resize(kept_ * 2 * forced_.size());
}

void PressureGrid::reset() noexcept {
    for (Pressure& pressure : pressures_) {
        std::fill(pressure.ring.begin(), pressure.ring.end(), 0.0);
        pressure.open = {};
    }
    std::fill(moments_.begin(), moments_.end(), Moments{});
    std::fill(states_.begin(), states_.end(), 0.0);
    open_ = {};
    done_ = 0;
    jumps_heard_ = 0;
    force_before_ = 0;
    largest_force_ = 0;
    begins_ = true;
    line_ = std::max<std::int64_t>(1, first_delay_.times(intervals_per_sample_).rounded_up());
}

void PressureGrid::continue_from(const PressureGrid& before, std::int64_t samples) noexcept {
    const auto shift = [](const auto* from, std::size_t size, std::size_t by, auto* to) {
        std::rotate_copy(from, from + by % size, from + size, to);
    };
    for (std::size_t i = 0; i < pressures_.size(); ++i) {
        const Pressure& from = before.pressures_[i];
        shift(from.ring.data(), from.ring.size(), static_cast<std::size_t>(samples),
              pressures_[i].ring.data());
        pressures_[i].open = from.open;
    }
    const std::int64_t lines = samples * intervals_per_sample_;
    const auto by = static_cast<std::size_t>(lines);
    shift(before.moments_.data(), kept_, by, moments_.data());
    std::copy_n(moments_.data(), kept_, moments_.data() + kept_);
    shift(before.states_.data(), states_.size(), by * 2 * forced_.size(), states_.data());
    open_ = before.open_;
    line_ = before.line_ - lines;
    done_ = 0;
    jumps_ = before.jumps_;
    jumps_heard_ = before.jumps_heard_;
    for (Jump& jump : jumps_) {
        jump.at.whole -= samples;
    }
    force_before_ = before.force_before_;
    largest_force_ = before.largest_force_;
    begins_ = true;
}

double PressureGrid::force_at(double z) const noexcept {
    if (piece_.plate == nullptr || !plate_.moves) {
        return 0;
    }
    double force = 0;
    for (auto m = static_cast<std::size_t>(piece_.degree()) - 1; m-- > 0;) {
        force = force * z + plate_.force_terms[m];
    }
    for (const kernels::OnsetForce& onset : plate_.onset_forces) {
        double value = 0;
        for (int n = kernels::onset_terms; n-- > 0;) {
            value = value * z + onset.term(n, plate_.end_slot);
        }
        force += onset.power(z) * value / (plate_.mobility() * piece_.unit_s * piece_.unit_s);
    }
    return force;
}

/// The time of the line, counted from the arrival of the first sound that left at that moment [samples].
double PressureGrid::samples_after(FixedTime moment, std::int64_t line) const noexcept {
    moment.advance(first_delay_);
    const double part =
        static_cast<double>(line % intervals_per_sample_) / static_cast<double>(intervals_per_sample_);
    return difference({line / intervals_per_sample_, 0}, moment) + part;
}

/// How long the end of the open interval is after it [intervals].
double PressureGrid::age_of(FixedTime moment) const noexcept {
    return samples_after(moment, line_) * static_cast<double>(intervals_per_sample_);
}

/// Notes a jump where a piece begins. Jumps older than all kernels are dropped.
void PressureGrid::note_jump(const Stretch& piece) noexcept {
    constexpr double negligible =
        1e-6;  // of the largest force; pieces join no better than to their tolerance
    begins_ = false;
    const double now = force_at(0);
    const double jump = now - force_before_;
    largest_force_ = std::max(largest_force_, std::abs(now));
    if (std::abs(jump) <= negligible * largest_force_) {
        return;
    }
    const auto heard =
        std::remove_if(jumps_.begin(), jumps_.begin() + static_cast<std::ptrdiff_t>(jumps_heard_),
                       [this](const Jump& old) { return age_of(old.at) > static_cast<double>(kept_ + 1); });
    jumps_heard_ = static_cast<std::size_t>(heard - jumps_.begin());
    if (jumps_heard_ == most_jumps) {
        std::shift_left(jumps_.begin(), jumps_.end(), 1);
        --jumps_heard_;
    }
    jumps_[jumps_heard_++] = {piece.begin, jump};
}

/// Where a line lies in the piece [z].
double PressureGrid::place_of(std::int64_t line, const Stretch& piece) const noexcept {
    return samples_after(piece.begin, line) * (sample_period_s_ / piece_.unit_s);
}

/// Of the sample that is known at the end of the open interval.
double PressureGrid::value(const Pressure& pressure) const noexcept {
    const ForceKernel& kernel = pressure.kernel;
    const double* const newest = pressure.share < 1 ? pressure.open.data() : open_.data();
    const double sum = std::inner_product(kernel.newest.begin(), kernel.newest.end(), newest, 0.0);
    // the intervals before lie in the ring up to line_ - 1
    const auto end = static_cast<std::size_t>(line_ - 1) % kept_ + kept_;
    double rest = 0;
    for (std::size_t i = 0; i < jumps_heard_; ++i) {
        rest += jumps_[i].force * kernel.rest_of_jump(age_of(jumps_[i].at) - (1 - pressure.share));
    }
    return sum + rest +
           kernels_.sum_of_products(kernel.moments.data(), moments_[end - kernel.intervals].data(),
                                    kernel.moments.size()) +
           kernels_.sum_of_products(
               kernel.states.data(),
               states_at(line_ - 1 + static_cast<std::int64_t>(kept_ - kernel.intervals)),
               kernel.states.size());
}

/// Adds the force over the next part of the open interval. @param until its end @param line the interval's end [z]
void PressureGrid::add_force(double until, double line, double interval) noexcept {
    const double start = line - interval;
    constexpr double rounding = 1e-12;
    if (until == line && done_ - start < rounding * interval && plate_.onset_forces.empty()) {
        kernels_.whole_interval_moments(plate_, {start, line, line, interval, piece_.unit_s}, open_.data());
    } else {
        kernels_.add_force_moments(plate_, {done_, until, line, interval, piece_.unit_s}, open_.data());
    }
    for (Pressure& pressure : pressures_) {
        const double end = line - (1 - pressure.share) * interval;
        if (pressure.share < 1 && done_ < end && is_due(pressure)) {
            kernels_.add_force_moments(
                plate_, {done_, std::min(until, end), end, pressure.share * interval, piece_.unit_s},
                pressure.open.data());
        }
    }
}

void PressureGrid::end_interval() noexcept {
    for (Pressure& pressure : pressures_) {
        if (is_due(pressure)) {
            pressure.at((line_ - 1 + pressure.delay) / intervals_per_sample_) = value(pressure);
            pressure.open = {};
        }
    }
    const auto place = static_cast<std::size_t>(line_ - 1) % kept_;
    moments_[place] = moments_[place + kept_] = open_;
    kernels_.advance_states(forced_, open_.data(), states_at(line_ - 1), states_at(line_));
    open_ = {};
    ++line_;
}

/// Goes on through the piece. @param until [z]
void PressureGrid::send(double until, const Stretch& piece) noexcept {
    const bool moves = piece_.plate != nullptr && plate_.moves;
    const double interval = sample_period_s_ / piece_.unit_s / static_cast<double>(intervals_per_sample_);
    if (begins_) {
        note_jump(piece);
    }
    for (;;) {
        const double line = place_of(line_, piece);
        const double to = std::min(line, until);
        if (to > done_) {
            if (moves) {
                add_force(to, line, interval);
            }
            done_ = to;
        }
        if (line > until) {
            return;
        }
        end_interval();
    }
}

void PressureGrid::send_for(std::int64_t last, const Stretch& piece) noexcept {
    const std::int64_t line = last * intervals_per_sample_ - soonest_ + 1;
    if (line_ <= line) {
        send(place_of(line, piece), piece);
    }
}

void PressureGrid::leave_piece(const Stretch& piece) noexcept {
    const double end = difference(piece.end, piece.begin) * sample_period_s_ / piece_.unit_s;
    send(end, piece);
    done_ = 0;
    force_before_ = force_at(end);
    begins_ = true;
}

}  // namespace hertzline
