#include "core/solvers/sampling/plate_outputs.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace hertzline {

PlateOutputs::PlateOutputs(const Chain& chain, kernels::PlateMotion* plate, const kernels::SeriesPiece& piece,
                           const ResolvedScene& resolved, TapSet taps)
    : plate_(plate),
      kernels_(kernels::series_kernels(resolved.integrator(), 1, chain.damping_law)),
      piece_(piece),
      sample_period_s_(1 / resolved.scene().output.sample_rate_hz) {
    if (plate_ == nullptr) {
        return;
    }
    plate_->shows_face = taps.contains(Tap::v_face) || taps.contains(Tap::v_out);
    const PlateResponse& response = *chain.end.plate;
    const PlateParameters& p = response.parameters;
    const ShapeTable shapes(disc_modes(p));
    std::vector<PointSound> sounds;
    const Output& output = resolved.scene().output;
    if (taps.contains(Tap::p_axis)) {
        sounds.emplace_back(shapes, 0, output.hydrophone_m / p.radius_m);
        on_axis_ = 1;
    }
    if (taps.contains(Tap::p_points)) {
        for (const auto& [x, y, z] : output.points_m) {
            sounds.emplace_back(shapes, std::hypot(x, y) / p.radius_m, z / p.radius_m);
        }
    }
    if (sounds.empty()) {
        return;
    }
    const double unit_s = p.radius_m / p.fluid.sound_speed_m_per_s;
    double nearest = sounds.front().first();
    double longest_s = sample_period_s_;
    for (const PointSound& sound : sounds) {
        nearest = std::min(nearest, sound.first());
        longest_s =
            std::min(longest_s, longest_interval_s(response, unit_s * (sound.last() - sound.first())));
    }
    intervals_per_sample_ = static_cast<std::int64_t>(std::ceil(sample_period_s_ / longest_s * (1 - 1e-9)));
    const double interval_s = sample_period_s_ / static_cast<double>(intervals_per_sample_);
    forced_ = std::make_unique<ForcedStates>(response, interval_s);
    first_delay_ = FixedTime::of(nearest * unit_s / sample_period_s_);
    for (const PointSound& sound : sounds) {
        const double later = (sound.first() - nearest) * unit_s / interval_s;
        const double whole = std::floor(later);
        const double share = 1 - (later - whole);
        pressures_.push_back({.kernel = ForceKernel(response, sound, interval_s, share),
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
    states_.resize(kept_ * 2 * forced_->size());
}

void PlateOutputs::reset() noexcept {
    for (Pressure& pressure : pressures_) {
        std::fill(pressure.ring.begin(), pressure.ring.end(), 0.0);
        pressure.open = {};
    }
    std::fill(moments_.begin(), moments_.end(), Moments{});
    std::fill(states_.begin(), states_.end(), 0.0);
    open_ = {};
    done_ = 0;
    line_ = std::max<std::int64_t>(1, first_delay_.times(intervals_per_sample_).rounded_up());
}

void PlateOutputs::continue_from(const PlateOutputs& before, std::int64_t samples) noexcept {
    const auto shift = [](const auto* from, std::size_t size, std::size_t by, auto* to) {
        std::rotate_copy(from, from + by % size, from + size, to);
    };
    for (std::size_t i = 0; i < pressures_.size(); ++i) {
        const Pressure& from = before.pressures_[i];
        shift(from.ring.data(), from.ring.size(), static_cast<std::size_t>(samples),
              pressures_[i].ring.data());
        pressures_[i].open = from.open;
    }
    if (kept_ > 0) {
        const std::int64_t lines = samples * intervals_per_sample_;
        const auto by = static_cast<std::size_t>(lines);
        shift(before.moments_.data(), kept_, by, moments_.data());
        std::copy_n(moments_.data(), kept_, moments_.data() + kept_);
        shift(before.states_.data(), states_.size(), by * 2 * forced_->size(), states_.data());
        open_ = before.open_;
        line_ = before.line_ - lines;
    }
    done_ = 0;
}

double PlateOutputs::velocity(const kernels::PlateMotion::Velocity& of, double z) const noexcept {
    if (piece_.plate == nullptr) {
        return 0;
    }
    const auto at = [this, z](const auto& terms) {
        double value = 0;
        for (auto k = static_cast<std::size_t>(piece_.degree()); k-- > 0;) {
            value = value * z + terms[k];
        }
        return value;
    };
    double sum = at(of.terms);
    for (std::size_t i = 0; i < plate_->onset_forces.size(); ++i) {
        sum += plate_->onset_forces[i].integrated_power(std::max(z, 0.0)) * at(of.onset_terms[i]);
    }
    return sum;
}

/// Where a line lies in the piece [z].
double PlateOutputs::place_of(std::int64_t line, const Stretch& piece) const noexcept {
    FixedTime arrival = piece.begin;
    arrival.advance(first_delay_);
    const double part =
        static_cast<double>(line % intervals_per_sample_) / static_cast<double>(intervals_per_sample_);
    return (difference({line / intervals_per_sample_, 0}, arrival) + part) *
           (sample_period_s_ / piece_.unit_s);
}

/// Of the sample that is known at the end of the open interval.
double PlateOutputs::pressure(const Pressure& point) const noexcept {
    const ForceKernel& kernel = point.kernel;
    const double* const newest = point.share < 1 ? point.open.data() : open_.data();
    const double sum = std::inner_product(kernel.newest.begin(), kernel.newest.end(), newest, 0.0);
    // the intervals before lie in the ring up to line_ - 1
    const auto end = static_cast<std::size_t>(line_ - 1) % kept_ + kept_;
    return sum +
           kernels_.sum_of_products(kernel.moments.data(), moments_[end - kernel.intervals].data(),
                                    kernel.moments.size()) +
           kernels_.sum_of_products(
               kernel.states.data(),
               states_at(line_ - 1 + static_cast<std::int64_t>(kept_ - kernel.intervals)),
               kernel.states.size());
}

/// Adds the force over the next part of the open interval. @param until its end @param line the interval's end [z]
void PlateOutputs::add_force(double until, double line, double interval) noexcept {
    const double start = line - interval;
    constexpr double rounding = 1e-12;
    if (until == line && done_ - start < rounding * interval && plate_->onset_forces.empty()) {
        kernels_.whole_interval_moments(*plate_, {start, line, line, interval, piece_.unit_s}, open_.data());
    } else {
        kernels_.add_force_moments(*plate_, {done_, until, line, interval, piece_.unit_s}, open_.data());
    }
    for (Pressure& point : pressures_) {
        const double end = line - (1 - point.share) * interval;
        if (point.share < 1 && done_ < end && is_due(point)) {
            kernels_.add_force_moments(
                *plate_, {done_, std::min(until, end), end, point.share * interval, piece_.unit_s},
                point.open.data());
        }
    }
}

void PlateOutputs::end_interval() noexcept {
    for (Pressure& point : pressures_) {
        if (is_due(point)) {
            point.at((line_ - 1 + point.delay) / intervals_per_sample_) = pressure(point);
            point.open = {};
        }
    }
    const auto place = static_cast<std::size_t>(line_ - 1) % kept_;
    moments_[place] = moments_[place + kept_] = open_;
    kernels_.advance_states(*forced_, open_.data(), states_at(line_ - 1), states_at(line_));
    open_ = {};
    ++line_;
}

/// Goes on through the piece. @param until [z]
void PlateOutputs::send(double until, const Stretch& piece) noexcept {
    const bool moves = piece_.plate != nullptr && plate_->moves;
    const double interval = sample_period_s_ / piece_.unit_s / static_cast<double>(intervals_per_sample_);
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

void PlateOutputs::put_velocity(const kernels::PlateMotion::Velocity& of, const kernels::SampleTimes& times,
                                std::size_t count, double* out) const noexcept {
    if (piece_.plate == nullptr) {
        std::fill_n(out, count, 0.0);
    } else if (!plate_->onset_forces.empty()) {
        for (std::size_t i = 0; i < count; ++i) {
            out[i] = velocity(
                of, ((times.first_after_base + static_cast<double>(i)) - times.fraction) * times.per_sample);
        }
    } else {
        kernels_.polynomial(of.terms, times, count, out);
    }
}

void PlateOutputs::put(const EndMotion& motion, const kernels::SampleTimes& times, std::size_t count,
                       const Stretch& piece, std::int64_t first) noexcept {
    if (plate_ == nullptr) {
        return;
    }
    if (motion.v_face != nullptr) {
        put_velocity(plate_->face, times, count, motion.v_face + motion.count);
    }
    if (motion.p_axis != nullptr || motion.p_points != nullptr) {
        // a piece that is longer than the way sends pressures that arrive within it
        const std::int64_t last = first + static_cast<std::int64_t>(count) - 1;
        const std::int64_t line = last * intervals_per_sample_ - soonest_ + 1;
        if (line_ <= line) {
            send(place_of(line, piece), piece);
        }
        put_pressures(motion, count, first);
    }
}

/// Puts down the pressures that arrive in `count` samples. @param first number of the first sample
void PlateOutputs::put_pressures(const EndMotion& motion, std::size_t count, std::int64_t first) noexcept {
    const auto put = [count, first](Pressure& pressure, double* out, std::size_t stride) {
        for (std::size_t i = 0; i < count; ++i) {
            out[i * stride] = pressure.at(first + static_cast<std::int64_t>(i));
        }
    };
    if (motion.p_axis != nullptr) {
        put(pressures_.front(), motion.p_axis + motion.count, 1);
    }
    const std::size_t points = pressures_.size() - on_axis_;
    for (std::size_t point = 0; motion.p_points != nullptr && point < points; ++point) {
        put(pressures_[on_axis_ + point], motion.p_points + motion.count * points + point, points);
    }
}

void PlateOutputs::leave_piece(const Stretch& piece) noexcept {
    if (!pressures_.empty()) {
        send(difference(piece.end, piece.begin) * sample_period_s_ / piece_.unit_s, piece);
    }
    done_ = 0;
}

double PlateOutputs::bytes(const Scene& scene, TapSet taps) noexcept {
    const auto& fluid = std::get<Fluid>(*find_material(scene, scene.medium.material));
    const Output& output = scene.output;
    constexpr double per_interval = 72;  // kernel, moments and states, no longer than the way from the rim
    constexpr double intervals = 64;     // of a kernel
    double numbers = 0;
    const auto add = [&](double from_axis_m, double from_plane_m) {
        const double way_m = std::hypot(from_plane_m, from_axis_m + scene.end.radius_m);
        const double delay = way_m / fluid.sound_speed_m_per_s * output.sample_rate_hz;
        numbers += delay + static_cast<double>(EndTaps::max_count) + intervals * per_interval;
    };
    if (taps.contains(Tap::p_axis)) {
        add(0, output.hydrophone_m);
    }
    if (taps.contains(Tap::p_points)) {
        for (const auto& [x, y, z] : output.points_m) {
            add(std::hypot(x, y), z);
        }
    }
    return sizeof(double) * numbers;
}

}  // namespace hertzline
