#include "core/integrators/plate_motion.hpp"

#include <algorithm>
#include <cmath>

namespace hertzline::kernels {

namespace {

constexpr std::size_t modes_beside_each_other = 4;

/// The next whole multiple.
constexpr std::size_t whole(std::size_t count, std::size_t of) noexcept {
    return (count + of - 1) / of * of;
}

}  // namespace

PlateMotion::PlateMotion(const PlateResponse& response, std::size_t lanes, int degree, double unit_s)
    : response_(response),
      size_(whole(response.poles.size(), lanes)),
      stride_(whole(response.modes.size(), modes_beside_each_other)),
      degree_(static_cast<std::size_t>(degree)),
      unit_s_(unit_s),
      fastest_(size_),
      columns_(aligned_zeros(2 * size_ * 4)),
      flags_(aligned_zeros((2 + most_terms) * flag_stride)),
      tables_(aligned_zeros(stride_ * (4 * most_terms + 2 + degree_ * 2 * response.poles.size()))) {
    for (std::size_t n = 0; n < response.modes.size(); ++n) {
        const PlateMode& mode = response.modes[n];
        mode_m_.push_back(row_of(response.mode_m[n]));
        mode_m_per_s_.push_back(row_of(response.mode_m_per_s[n]));
        mode_losses()[n] = unit_s * mode.loss_kg_per_s;
        mean_shapes()[n] = mode.mean;
    }
    fill_columns(lanes);
    fill_tables();
}

void PlateMotion::fill_columns(std::size_t lanes) noexcept {
    for (std::size_t j = 0; j < pairs(); ++j) {
        const std::complex<double> pole = response_.poles[j];
        rate().re[j] = pole.real() * unit_s_;
        rate().im[j] = pole.imag() * unit_s_;
        for (std::size_t i = 0; i < size_; ++i) {
            fastest_[i] =
                j / lanes <= i / lanes ? std::max(fastest_[i], std::abs(pole) * unit_s_) : fastest_[i];
        }
        const std::complex<double> x = response_.centre_m[static_cast<Eigen::Index>(j)] / unit_s_;
        displacement().re[j] = 2 * x.real();
        displacement().im[j] = -2 * x.imag();
        velocity().re[j] = 2 * (x * pole).real();
        velocity().im[j] = -2 * (x * pole).imag();
    }
}

/// A derivative by z more is a pole times unit more. The states' reaction follows from the velocities of the modes together: what
/// changes these, beside the force, is a force on the body.
void PlateMotion::fill_tables() noexcept {
    double* const forced = mode_terms() + 3 * most_terms * stride_;
    for (std::size_t j = 0; j < pairs(); ++j) {
        const std::complex<double> rate = response_.poles[j] * unit_s_;
        for (std::size_t n = 0; n < modes(); ++n) {
            std::complex<double> factor =
                2.0 / unit_s_ * response_.mode_m_per_s[n][static_cast<Eigen::Index>(j)];
            double* const re = mean_shapes() + stride_ * (1 + degree_ * 2 * j) + n;
            double* const im = re + stride_ * degree_;
            for (std::size_t k = 0; k < degree_; ++k, factor *= rate) {
                re[k * stride_] = factor.real();
                im[k * stride_] = -factor.imag();
                forced[k * stride_ + n] += factor.real();
                if (k > 0) {
                    answer[k - 1] += reaction() * factor.real();
                }
            }
        }
    }
}

PlateMotion::Row PlateMotion::row_of(const Eigen::VectorXcd& residues) const {
    Row row(2 * size_);
    for (std::size_t j = 0; j < response_.poles.size(); ++j) {
        const std::complex<double> factor = residues[static_cast<Eigen::Index>(j)] / unit_s_;
        row[j] = 2 * factor.real();
        row[size_ + j] = -2 * factor.imag();
    }
    return row;
}

double PlateMotion::of(const Row& row, const Pairs& states) const noexcept {
    double sum = 0;
    for (std::size_t j = 0; j < size_; ++j) {
        sum += row[j] * states.re[j] + row[size_ + j] * states.im[j];
    }
    return sum;
}

void PlateMotion::find_slots(const SimdChain& chain) noexcept {
    const auto end = static_cast<std::size_t>(chain.active()) - 1;
    const auto slot = [&chain](std::size_t body) {
        return body % chain.rows() * chain.lanes() + body / chain.rows();
    };
    end_slot = slot(end);
    pad_slot = slot(end + 1);
    std::fill_n(flags_.get(), 2 * flag_stride, 0.0);
    if (chain.slots() <= flag_stride) {
        flags_[end_slot] = 1;
        flags_[flag_stride + pad_slot] = 1;
    }
}

void PlateMotion::rest() noexcept {
    std::fill_n(state().re, 2 * size_, 0.0);
    std::fill_n(mode_terms(), most_terms * stride_, 0.0);
    centre = face = {};
    onset_forces = {};
    moves = false;
}

void PlateMotion::reset() noexcept {
    rest();
    passed = lost = 0;
}

void PlateMotion::continue_from(const PlateMotion& before) noexcept {
    const double scale = unit_s_ / before.unit_s_;
    std::transform(before.state().re, before.state().re + 2 * size_, state().re,
                   [scale](double state) { return scale * state; });
    moves = before.moves;
    passed = before.passed;
    lost = before.lost;
}

double PlateMotion::energy() const noexcept {
    double twice = 0;
    for (std::size_t n = 0; n < response_.modes.size(); ++n) {
        const double q = of(mode_m_[n], state());
        const double v = of(mode_m_per_s_[n], state());
        twice += response_.modes[n].stiffness_n_per_m * q * q + response_.modes[n].mass_kg * v * v;
    }
    return twice / 2;
}

}  // namespace hertzline::kernels
