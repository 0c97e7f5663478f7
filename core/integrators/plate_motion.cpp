#include "core/integrators/plate_motion.hpp"

#include <algorithm>
#include <cmath>
#include <new>

namespace hertzline::kernels {

namespace {

constexpr std::align_val_t alignment{64};  // of the widest vector register

double* zeros(std::size_t count) {
    auto* const room = static_cast<double*>(::operator new[](count * sizeof(double), alignment));
    std::fill_n(room, count, 0.0);
    return room;
}

}  // namespace

void PlateMotion::Free::operator()(double* p) const noexcept {
    ::operator delete[](p, alignment);
}

/// States are kept times unit, so that their input is a force times unit^2, as the kernels have it.
PlateMotion::PlateMotion(const PlateResponse& response, std::size_t lanes, int degree, double unit_s)
    : response_(response),
      size_((response.poles.size() + lanes - 1) / lanes * lanes),
      degree_(degree),
      unit_s_(unit_s),
      columns_(zeros(2 * size_ * (6 + static_cast<std::size_t>(degree)))),
      flags_(zeros(3 * flag_stride)),
      modes_(zeros((2 * size_ + most_terms + 1) * mode_stride)) {
    for (std::size_t j = 0; j < response.poles.size(); ++j) {
        const std::complex<double> pole = response.poles[j];
        rate().re[j] = pole.real() * unit_s;
        rate().im[j] = pole.imag() * unit_s;
        const std::complex<double> x = response.centre_m[static_cast<Eigen::Index>(j)];
        const auto put = [j](const Pairs& row, std::complex<double> factor) {
            row.re[j] = 2 * factor.real();
            row.im[j] = -2 * factor.imag();
        };
        put(displacement(), x / unit_s);
        put(velocity(), x * pole / unit_s);
        put(reaction(), -unit_s / response.mobility * x * pole * pole);
        weight().re[j] = weight().im[j] = 2 * std::abs(x * pole);
    }
    for (std::size_t n = 0; n < response.modes.size(); ++n) {
        mode_m_.push_back(row_of(response.mode_m[n]));
        mode_m_per_s_.push_back(row_of(response.mode_m_per_s[n]));
        for (std::size_t j = 0; j < 2 * size_; ++j) {
            mode_rows()[j * mode_stride + n] = mode_m_per_s_.back()[j];
        }
        mode_losses()[n] = unit_s * response.modes[n].loss_kg_per_s;
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
    std::fill_n(flags_.get(), 3 * flag_stride, 0.0);
    if (chain.slots() <= flag_stride) {
        flags_[end_slot] = 1;
        flags_[flag_stride + pad_slot] = 1;
    }
}

void PlateMotion::rest() noexcept {
    std::fill_n(state().re, 2 * size_, 0.0);
    std::fill_n(derivative(0).re, 2 * size_ * static_cast<std::size_t>(degree_), 0.0);
}

void PlateMotion::reset() noexcept {
    rest();
    passed = lost = 0;
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

double PlateMotion::share_at_once(std::size_t mode) const noexcept {
    return 2 * response_.mode_m_per_s[mode].real().sum() / response_.mobility;
}

}  // namespace hertzline::kernels
