#include "core/solvers/sampling/plate_outputs.hpp"

#include <algorithm>
#include <cmath>

#include "core/plate/quadrature.hpp"

namespace hertzline {

namespace {

/// The kernel's and the velocities' waves are much longer. The error falls with the fifth power: as fine as the fit.
double longest_interval_s(const PlateResponse& response) noexcept {
    constexpr std::size_t coarse_pairs = 21;  // 40 poles, two of them real
    return response.poles.size() > coarse_pairs ? 40e-9 : 50e-9;
}

/// The polynomials of Legendre at -1 <= x <= 1.
std::array<double, PlateOutputs::moments> legendre(double x) noexcept {
    return {1, x, 0.5 * (3 * x * x - 1), 0.5 * x * (5 * x * x - 3)};
}

}  // namespace

PlateOutputs::PlateOutputs(const Chain& chain, kernels::PlateMotion* plate, const kernels::SeriesPiece& piece,
                           Integrator integrator, double sample_period_s, TapSet taps)
    : plate_(plate),
      kernels_(kernels::series_kernels(integrator, 1, chain.damping_law)),
      piece_(piece),
      sample_period_s_(sample_period_s) {
    if (plate_ == nullptr) {
        return;
    }
    plate_->shows_modes =
        taps.contains(Tap::p_axis) || taps.contains(Tap::v_face) || taps.contains(Tap::v_out);
    if (!taps.contains(Tap::p_axis)) {
        return;
    }
    has_pressure_ = true;
    delay_ = FixedTime::of(chain.end.plate->parameters.travel_s() / sample_period_s);
    ring_.resize(static_cast<std::size_t>(delay_.whole) + EndTaps::max_count + 2);
    intervals_per_sample_ = static_cast<std::int64_t>(
        std::ceil(sample_period_s / longest_interval_s(*chain.end.plate) * (1 - 1e-9)));
    make_kernel(*chain.end.plate, sample_period_s);
}

/// The slope of h(s) = c phi(sqrt(c^2 s^2 - z^2)) on intervals from z/c on: its Legendre coefficients times rho. The earliest sound, which
/// has gone farthest, comes first.
void PlateOutputs::make_kernel(const PlateResponse& response, double sample_period_s) {
    const PlateParameters& p = response.parameters;
    const double c = p.fluid.sound_speed_m_per_s;
    rho_c_ = p.fluid.density_kg_per_m3 * c;
    const double a = p.radius_m;
    const double z = p.hydrophone_m;
    const double way = a / (std::hypot(z / a, 1.0) + z / a);  // of the last sound beyond the first
    const double interval = c * sample_period_s / static_cast<double>(intervals_per_sample_);
    const auto intervals = static_cast<std::size_t>(std::ceil(way / interval));
    const std::size_t stride = plate_->stride();
    per_interval_ = moments * stride;
    kernel_.resize(intervals * per_interval_);
    history_.resize(kernel_.size());
    open_.resize(per_interval_);
    const std::vector<DiscMode> modes = disc_modes(p);
    for (std::size_t n = 0; n < modes.size(); ++n) {
        const DiscMode& mode = modes[n];
        for (std::size_t j = 0; j < intervals; ++j) {
            const double begin = static_cast<double>(j) * interval;
            const double end = std::min(begin + interval, way);
            each_node<24>(begin, end, [&](double beyond, double weight) {
                const double r = std::min(1.0, std::sqrt(beyond * (beyond + 2 * z)) / a);
                const double slope = rho_c_ * mode.slope_over_r(r) * (z + beyond) / (a * a);
                const auto polynomials = legendre(1 - 2 * (beyond - begin) / interval);
                for (std::size_t q = 0; q < moments; ++q) {
                    // the coefficient, and 1/c for the integral over time instead of way
                    kernel_[(intervals - 1 - j) * per_interval_ + q * stride + n] +=
                        (2 * static_cast<double>(q) + 1) / interval * weight * slope * polynomials[q] * c;
                }
            });
        }
    }
}

void PlateOutputs::reset() noexcept {
    std::fill(ring_.begin(), ring_.end(), 0.0);
    std::fill(history_.begin(), history_.end(), 0.0);
    std::fill(open_.begin(), open_.end(), 0.0);
    done_ = 0;
    // the first line that lies behind the start
    FixedTime lines = delay_.times(intervals_per_sample_);
    line_ = lines.rounded_up();
}

void PlateOutputs::continue_from(const PlateOutputs& before, std::int64_t samples) noexcept {
    if (!has_pressure_) {
        return;
    }
    const auto shifted = [](const std::vector<double>& from, std::size_t by, std::vector<double>& to) {
        if (!from.empty()) {
            const auto middle = from.begin() + static_cast<std::ptrdiff_t>(by % from.size());
            std::rotate_copy(from.begin(), middle, from.end(), to.begin());
        }
    };
    const std::int64_t lines = samples * intervals_per_sample_;
    shifted(before.ring_, static_cast<std::size_t>(samples), ring_);
    shifted(before.history_, static_cast<std::size_t>(lines) * per_interval_, history_);
    std::copy(before.open_.begin(), before.open_.end(), open_.begin());
    line_ = before.line_ - lines;
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

/// Integrals over a part of the open interval. @param line where the interval ends [z]
void PlateOutputs::add_moments(double from, double to, double line) noexcept {
    const double interval = sample_period_s_ / piece_.unit_s / static_cast<double>(intervals_per_sample_);
    kernels_.add_moments(*plate_, piece_.degree(), {from, to, line, interval, piece_.unit_s}, open_.data());
}

/// At the line that has just been reached. @param centre velocity there [m/s]
double PlateOutputs::pressure(double centre) const noexcept {
    double sum = rho_c_ * centre;
    const std::size_t size = history_.size();
    if (size == 0) {
        return sum;
    }
    // the latest intervals lie up to the line's place in the ring, the others behind it
    const std::size_t latest = (static_cast<std::size_t>(line_) * per_interval_) % size + per_interval_;
    sum += kernels_.sum_of_products(kernel_.data() + (size - latest), history_.data(), latest);
    sum += kernels_.sum_of_products(kernel_.data(), history_.data() + latest, size - latest);
    return sum;
}

/// Where a line lies in the piece [z].
double PlateOutputs::place_of(std::int64_t line, const Stretch& piece) const noexcept {
    FixedTime arrival = piece.begin;
    arrival.advance(delay_);
    const double part =
        static_cast<double>(line % intervals_per_sample_) / static_cast<double>(intervals_per_sample_);
    return (difference({line / intervals_per_sample_, 0}, arrival) + part) *
           (sample_period_s_ / piece_.unit_s);
}

/// Goes on through the piece. @param until [z]
void PlateOutputs::send(double until, const Stretch& piece) noexcept {
    const bool moves = piece_.plate != nullptr && plate_->moves;
    for (;;) {
        const double line = place_of(line_, piece);
        const double to = std::min(line, until);
        if (to > done_) {
            if (moves) {
                add_moments(done_, to, line);
            }
            done_ = to;
        }
        if (line > until) {
            return;
        }
        if (!history_.empty()) {
            const std::size_t place = (static_cast<std::size_t>(line_) * per_interval_) % history_.size();
            std::copy(open_.begin(), open_.end(), history_.begin() + static_cast<std::ptrdiff_t>(place));
        }
        if (line_ % intervals_per_sample_ == 0) {
            in_ring(line_ / intervals_per_sample_) = pressure(velocity(plate_->centre, line));
        }
        std::fill(open_.begin(), open_.end(), 0.0);
        ++line_;
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
    const std::size_t at = motion.count;
    if (motion.v_face != nullptr) {
        put_velocity(plate_->face, times, count, motion.v_face + at);
    }
    if (motion.p_axis != nullptr) {
        // a piece that is longer than the way sends pressures that arrive within it
        const std::int64_t last = first + static_cast<std::int64_t>(count) - 1;
        if (line_ <= last * intervals_per_sample_) {
            send(place_of(last * intervals_per_sample_, piece), piece);
        }
        for (std::size_t i = 0; i < count; ++i) {
            motion.p_axis[at + i] = in_ring(first + static_cast<std::int64_t>(i));
        }
    }
}

void PlateOutputs::leave_piece(const Stretch& piece) noexcept {
    if (has_pressure_) {
        send(difference(piece.end, piece.begin) * sample_period_s_ / piece_.unit_s, piece);
    }
    done_ = 0;
}

double PlateOutputs::bytes(double delay) noexcept {
    constexpr double kernel_share =
        16.0 * static_cast<double>(moments);  // no kernel is longer than the way from the rim
    return 8 * (delay + static_cast<double>(EndTaps::max_count)) * (1 + kernel_share);
}

}  // namespace hertzline
