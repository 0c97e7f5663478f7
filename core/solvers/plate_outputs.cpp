#include "core/solvers/plate_outputs.hpp"

#include <algorithm>
#include <cmath>

#include "core/plate/disc_modes.hpp"
#include "core/plate/quadrature.hpp"

namespace hertzline {

namespace {

/// The kernel's and the velocities' waves are much longer. What is left out falls with the fifth power: as fine as the fit.
double longest_interval_s(const PlateResponse& response) noexcept {
    constexpr std::size_t coarse_pairs = 21;  // 40 poles, two of them real
    return response.poles.size() > coarse_pairs ? 40e-9 : 100e-9;
}

/// The polynomials of Legendre at -1 <= x <= 1.
std::array<double, PlateOutputs::moments> legendre(double x) noexcept {
    return {1, x, 0.5 * (3 * x * x - 1), 0.5 * x * (5 * x * x - 3)};
}

}  // namespace

PlateOutputs::PlateOutputs(const Chain& chain, kernels::PlateMotion* plate, const kernels::SeriesPiece& piece,
                           double sample_period_s, TapSet taps)
    : plate_(plate),
      kernels_(kernels::series_kernels(Integrator::taylor8, 1,
                                       DampingLaw::dashpot)),  // these do not hang on the order
      piece_(piece),
      sample_period_s_(sample_period_s) {
    if (plate_ == nullptr) {
        return;
    }
    for (std::size_t n = 0; n < plate_->modes(); ++n) {
        centre_at_once_ += plate_->share_at_once(n);
        face_at_once_ += plate_->mean_shape(n) * plate_->share_at_once(n);
    }
    plate_->wants_modes =
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
    kernel_.resize(static_cast<std::size_t>(std::ceil(way / interval)));
    history_.resize(kernel_.size());
    for (std::size_t n = 0; n < response.modes.size(); ++n) {
        const DiscMode mode(static_cast<int>(n));
        for (std::size_t j = 0; j < kernel_.size(); ++j) {
            const double begin = static_cast<double>(j) * interval;
            const double end = std::min(begin + interval, way);
            each_node<24>(begin, end, [&](double beyond, double weight) {
                const double r = std::min(1.0, std::sqrt(beyond * (beyond + 2 * z)) / a);
                const double slope = rho_c_ * mode.slope_over_r(r) * (z + beyond) / (a * a);
                const auto polynomials = legendre(1 - 2 * (beyond - begin) / interval);
                for (std::size_t q = 0; q < moments; ++q) {
                    // the coefficient, and 1/c for the integral over time instead of way
                    kernel_[kernel_.size() - 1 - j][q * stride + n] +=
                        (2 * static_cast<double>(q) + 1) / interval * weight * slope * polynomials[q] * c;
                }
            });
        }
    }
}

void PlateOutputs::reset() noexcept {
    std::fill(ring_.begin(), ring_.end(), 0.0);
    std::fill(history_.begin(), history_.end(), Moments{});
    open_ = {};
    done_ = 0;
    velocities_.reset();
    // the first line that lies behind the start
    FixedTime lines = delay_.times(intervals_per_sample_);
    line_ = lines.rounded_up();
}

const PlateVelocities& PlateOutputs::velocities() noexcept {
    if (velocities_) {
        return *velocities_;
    }
    PlateVelocities& sums = velocities_.emplace();
    sums.centre.at_once = centre_at_once_;
    sums.face.at_once = face_at_once_;
    if (piece_.plate == nullptr) {
        return sums;
    }
    for (std::size_t n = 0; n < plate_->modes(); ++n) {
        const double mean = plate_->mean_shape(n);
        for (std::size_t k = 0; k < static_cast<std::size_t>(piece_.degree()); ++k) {
            const double term = plate_->mode_terms()[k * stride + n];
            sums.centre.terms[k] += term;
            sums.face.terms[k] += mean * term;
            sums.none = sums.none && term == 0;
        }
    }
    return sums;
}

/// The polynomial and, after a closing, what the onset forces add.
double PlateOutputs::velocity(const SumOfModes& sum, double z) const noexcept {
    double value = 0;
    for (auto k = static_cast<std::size_t>(piece_.degree()); k-- > 0;) {
        value = value * z + sum.terms[k];
    }
    if (piece_.onset) {
        for (const kernels::OnsetForce& force : piece_.onset_forces()) {
            double power = force.integrated_power(std::max(z, 0.0)) * piece_.per_unit;
            for (int i = 0; i < kernels::onset_terms; ++i, power *= z) {
                value += sum.at_once * force.term(i, plate_->end_slot) * power / (i + (force.exponent + 1));
            }
        }
    }
    return value;
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
    // the latest intervals lie before the line's place in the ring, the others behind it
    const std::size_t place = static_cast<std::size_t>(line_) % size;
    const std::size_t before = place + 1;
    sum += kernels_.sum_of_products(kernel_[size - before].data(), history_[0].data(),
                                    before * Moments().size());
    sum += kernels_.sum_of_products(kernel_[0].data(), history_[place + 1 < size ? place + 1 : 0].data(),
                                    (size - before) * Moments().size());
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
    const auto size = static_cast<std::int64_t>(history_.size());
    for (;;) {
        const double line = place_of(line_, piece);
        const double to = std::min(line, until);
        if (to > done_) {
            if (!velocities().none) {
                add_moments(done_, to, line);
            }
            done_ = to;
        }
        if (line > until) {
            return;
        }
        if (size > 0) {
            history_[static_cast<std::size_t>(line_ % size)] = open_;
        }
        if (line_ % intervals_per_sample_ == 0) {
            in_ring(line_ / intervals_per_sample_) = pressure(velocity(velocities().centre, line));
        }
        open_ = {};
        ++line_;
    }
}

void PlateOutputs::put(const EndMotion& motion, const kernels::SampleTimes& times, std::size_t count,
                       const Stretch& piece, std::int64_t first) noexcept {
    if (plate_ == nullptr) {
        return;
    }
    const std::size_t at = motion.count;
    for (std::size_t i = 0; motion.v_face != nullptr && i < count; ++i) {
        const double z =
            ((times.first_after_base + static_cast<double>(i)) - times.fraction) * times.per_sample;
        motion.v_face[at + i] = velocity(velocities().face, z);
    }
    if (motion.p_axis != nullptr) {
        // a piece that is longer than the way may send what arrives in it
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
    velocities_.reset();
}

double PlateOutputs::bytes(double delay) noexcept {
    constexpr double kernel_share =
        16.0 * static_cast<double>(moments);  // no kernel is longer than the way from the rim
    return 8 * (delay + static_cast<double>(EndTaps::max_count)) * (1 + kernel_share);
}

}  // namespace hertzline
