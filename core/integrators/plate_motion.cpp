#include "core/integrators/plate_motion.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

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
      columns_(aligned_zeros(2 * size_ * 4)),
      flags_(aligned_zeros(2 * flag_stride)),
      steps_(aligned_zeros((grid + 1) * degree_ * 2 * size_)),
      reaction_(aligned_zeros((2 * pairs() + degree_) * width)),
      face_rows_(aligned_zeros(2 * pairs() * width)),
      mode_rows_(aligned_zeros((2 * pairs() + 3) * mode_orders * stride_)) {
    for (std::size_t n = 0; n < response.modes.size(); ++n) {
        mode_m_.push_back(row_of(response.mode_m[n]));
        mode_m_per_s_.push_back(row_of(response.mode_m_per_s[n]));
        mode_losses()[n] = unit_s * response.modes[n].loss_kg_per_s;
    }
    fill_columns();
    fill_steps();
    fill_rows();
}

void PlateMotion::fill_columns() noexcept {
    for (std::size_t j = 0; j < pairs(); ++j) {
        const std::complex<double> pole = response_.poles[j];
        rate().re[j] = pole.real() * unit_s_;
        rate().im[j] = pole.imag() * unit_s_;
        const std::complex<double> x = response_.centre_m[static_cast<Eigen::Index>(j)] / unit_s_;
        displacement().re[j] = 2 * x.real();
        displacement().im[j] = -2 * x.imag();
        velocity().re[j] = 2 * (x * pole).real();
        velocity().im[j] = -2 * (x * pole).imag();
    }
}

/// Over one place of the grid by the series of the exponentials, over more by one place at a time: the force's derivatives there are those
/// at the start, moved.
void PlateMotion::fill_steps() noexcept {
    constexpr double step = 1.0 / grid;
    double fastest = 0;
    for (std::size_t j = 0; j < pairs(); ++j) {
        const std::complex<double> w = step * unit_s_ * response_.poles[j];
        fastest = std::max(fastest, std::abs(w));
        // step^(m + 1) sum_i w^i/(i + m + 1)!
        std::array<std::complex<double>, most_terms> first{};
        for (std::size_t m = 0; m + 1 < degree_; ++m) {
            std::complex<double> term = std::pow(step, m + 1) / std::tgamma(static_cast<double>(m) + 2);
            for (int i = 1; i < 60; ++i) {
                first[m] += term;
                term *= w / (static_cast<double>(m) + 1 + i);
            }
        }
        std::array<std::complex<double>, most_terms> sums{};
        for (int place = 0; place <= grid; ++place) {
            const std::complex<double> turned = std::exp(static_cast<double>(place) * w);
            turn(place).re[j] = turned.real();
            turn(place).im[j] = turned.imag();
            for (std::size_t m = 0; m + 1 < degree_; ++m) {
                answer(place, m).re[j] = sums[m].real();
                answer(place, m).im[j] = sums[m].imag();
            }
            for (std::size_t m = degree_ - 1; m-- > 0;) {
                sums[m] *= std::exp(w);
                double moved = 1;
                for (std::size_t k = m + 1; k-- > 0;) {
                    sums[m] += moved * first[k];
                    moved *= place * step / static_cast<double>(m + 1 - k);
                }
            }
        }
    }
    // until a term is below rounding
    terms_between_ = static_cast<int>(degree_) - 1;
    for (double term = 1; term > 1e-17 && terms_between_ < most_terms_between; ++terms_between_) {
        term *= fastest / (terms_between_ + 1);
    }
}

/// A derivative by z more is a pole times unit more. The states' reaction follows from the velocity under the contact: what changes it,
/// beside the force, is a force on the body.
void PlateMotion::fill_rows() noexcept {
    const double reaction = -unit_s_ / response_.mobility;  // per derivative by z of that velocity [kg unit]
    std::array<double, most_terms> answer_of_centre{};
    for (std::size_t j = 0; j < pairs(); ++j) {
        const std::complex<double> rate = response_.poles[j] * unit_s_;
        const auto pair = static_cast<Eigen::Index>(j);
        // the residue times the rate's powers in rows from `row` on, [real, imaginary][of a part]
        const auto put = [&](std::complex<double> residue, std::size_t count, double* row,
                             std::size_t of_part, std::size_t stride, const auto& scale) {
            std::complex<double> factor = 2.0 / unit_s_ * residue;
            for (std::size_t k = 0; k < count; ++k, factor *= rate) {
                row[k * stride] = scale(k) * factor.real();
                row[of_part + k * stride] = scale(k) * -factor.imag();
            }
        };
        const auto as_is = [](std::size_t) { return 1.0; };
        double* const reactions = reaction_.get() + 2 * j * width;
        put(response_.centre_m_per_s[pair] * rate, degree_ - 1, reactions, width, 1,
            [&](std::size_t k) { return reaction / std::tgamma(static_cast<double>(k) + 3); });
        std::complex<double> power = 2.0 / unit_s_ * response_.centre_m_per_s[pair] * rate;
        std::complex<double> mean = 0;
        for (std::size_t k = 0; k + 1 < degree_; ++k, power *= rate) {
            answer_of_centre[k] += reaction * power.real();
        }
        for (std::size_t n = 0; n < modes(); ++n) {
            const std::complex<double> residue = response_.mode_m_per_s[n][pair];
            mean += response_.modes[n].mean * residue;
            double* const row = mode_rows_.get() + 2 * j * mode_orders * stride_ + n;
            put(residue, mode_orders, row, mode_orders * stride_, stride_, as_is);
            for (std::size_t k = 0; k < mode_orders; ++k) {
                mode_rows_[2 * pairs() * mode_orders * stride_ + k * stride_ + n] += row[k * stride_];
            }
        }
        put(mean, degree_, face_rows_.get() + 2 * j * width, width, 1, as_is);
        for (std::size_t k = 0; k < degree_; ++k) {
            face_answer[k] += face_rows_[2 * j * width + k];
        }
    }
    for (std::size_t m = 0; m + 1 < degree_; ++m) {
        double* const row = reaction_.get() + (2 * pairs() + m) * width;
        for (std::size_t n = m + 1; n + 1 < degree_; ++n) {
            row[n] = answer_of_centre[n - 1 - m] * std::tgamma(static_cast<double>(m) + 3) /
                     std::tgamma(static_cast<double>(n) + 3);
        }
    }
}

const PlateMotion::EndProducts& PlateMotion::products_of_ends() noexcept {
    static const EndProducts products = [] {
        constexpr int size = 2 * mode_orders;
        using Square = Eigen::Matrix<double, size, size>;
        Square values = Square::Zero();  // the derivatives of x^column at both ends
        Square integrals;                // of x^row x^column
        for (int power = 0; power < size; ++power) {
            double factor = 1;
            for (int order = 0; order < static_cast<int>(mode_orders); ++order) {
                values(order, power) = order == power ? factor : 0;
                values(static_cast<int>(mode_orders) + order, power) = factor;
                factor *= power - order;
            }
            for (int other = 0; other < size; ++other) {
                integrals(power, other) = 1.0 / (power + other + 1);
            }
        }
        const Square polynomials = values.inverse();  // coefficients in columns
        const Square all = polynomials.transpose() * integrals * polynomials;
        EndProducts rows{};
        for (int i = 0; i < size; ++i) {
            for (int j = 0; j < size; ++j) {
                rows[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)] = all(i, j);
            }
        }
        return rows;
    }();
    return products;
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
    end_row = end_slot / chain.lanes();
    end_lane.fill(static_cast<std::int64_t>(end_slot % chain.lanes()));
    std::fill_n(flags_.get(), 2 * flag_stride, 0.0);
    if (chain.slots() <= flag_stride) {
        flags_[end_slot] = 1;
        flags_[flag_stride + pad_slot] = 1;
    }
}

void PlateMotion::rest() noexcept {
    std::fill_n(state().re, 2 * size_, 0.0);
    std::fill_n(modes_before(), mode_orders * stride_, 0.0);
    face = {};
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
    look_at_modes();
}

/// The modes as they are now.
void PlateMotion::look_at_modes() noexcept {
    const std::size_t row = mode_orders * stride_;
    std::fill_n(modes_before(), row, 0.0);
    for (std::size_t j = 0; j < pairs(); ++j) {
        for (std::size_t k = 0; k < row; ++k) {
            modes_before()[k] += state().re[j] * mode_rows()[2 * j * row + k] +
                                 state().im[j] * mode_rows()[(2 * j + 1) * row + k];
        }
    }
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
