#include "core/plate/force_kernel.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/plate/quadrature.hpp"

namespace hertzline {

namespace {

using Complex = std::complex<double>;
using Eigen::Index;

constexpr std::size_t stretch_nodes = 24;  // of a panel

/// The polynomials of Legendre at -1 <= x <= 1.
template <std::size_t Count>
std::array<double, Count> legendre(double x) noexcept {
    std::array<double, Count> p{1, x};
    for (std::size_t q = 2; q < Count; ++q) {
        const auto n = static_cast<double>(q);
        p[q] = ((2 * n - 1) * x * p[q - 1] - (n - 1) * p[q - 2]) / n;
    }
    return p;
}

/// Integrals from -1 to each node of a function that is known at the nodes: a matrix.
const Eigen::MatrixXd& integrals_to_nodes() {
    static const Eigen::MatrixXd matrix = [] {
        const GaussNodes<stretch_nodes>& gauss = gauss_nodes<stretch_nodes>();
        Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(stretch_nodes, stretch_nodes);
        for (std::size_t k = 0; k < stretch_nodes; ++k) {
            const auto to = legendre<stretch_nodes + 1>(gauss.node[k]);
            for (std::size_t l = 0; l < stretch_nodes; ++l) {
                const auto at = legendre<stretch_nodes>(gauss.node[l]);
                double sum = to[1] + 1;
                for (std::size_t q = 1; q < stretch_nodes; ++q) {
                    sum += at[q] * (to[q + 1] - to[q - 1]);
                }
                sums(static_cast<Index>(k), static_cast<Index>(l)) = 0.5 * gauss.weight[l] * sum;
            }
        }
        return sums;
    }();
    return matrix;
}

std::size_t padded(std::size_t pairs) noexcept {
    constexpr std::size_t whole = 8;
    return (pairs + whole - 1) / whole * whole;
}

/// The answer of the states' acceleration to the sound's kernel, followed from the age of the first sound on: for each pair of poles
/// e' = p e + rho sum_n r_n h_n.
class Answer {
public:
    Answer(const PlateResponse& response, const PointSound& sound, double unit_s)
        : sound_(sound), unit_s_(unit_s) {
        const auto pairs = static_cast<Index>(response.poles.size());
        poles_ = Eigen::Map<const Eigen::ArrayXcd>(response.poles.data(), pairs);
        residues_.resize(pairs, static_cast<Index>(response.mode_m_per_s.size()));
        for (Index n = 0; n < residues_.cols(); ++n) {
            const Fluid& fluid = response.parameters.fluid;
            residues_.col(n) = fluid.density_kg_per_m3 * fluid.sound_speed_m_per_s *
                               response.mode_m_per_s[static_cast<std::size_t>(n)];
        }
        now_ = Eigen::ArrayXcd::Zero(pairs);
    }

    const Eigen::ArrayXcd& poles() const noexcept { return poles_; }
    const Eigen::ArrayXcd& now() const noexcept { return now_; }

    /// Goes on over a stretch in which the kernel is smooth. Calls visit(age, weight, answer) for the nodes of an integral.
    /// @param from, to ages [s] @param heard whether sound arrives then
    template <class Visit>
    void advance(double from, double to, bool heard, Visit visit) {
        const GaussNodes<stretch_nodes>& gauss = gauss_nodes<stretch_nodes>();
        const double span = to - from;
        const Index pairs = poles_.size();
        Eigen::ArrayXd ages(stretch_nodes);
        Eigen::ArrayXd weights(stretch_nodes);
        Eigen::ArrayXXcd input = Eigen::ArrayXXcd::Zero(pairs, stretch_nodes);
        for (Index i = 0; i < ages.size(); ++i) {
            const SmoothStep step = smooth_step(0.5 * (1 + gauss.node[static_cast<std::size_t>(i)]));
            ages[i] = span * step.value;
            weights[i] = 0.5 * span * step.slope;
            if (heard) {
                input.col(i) = (residues_ * sound_((from + ages[i]) / unit_s_).matrix()).array();
            }
        }
        // in a frame in which the states stand still
        Eigen::ArrayXXcd back(pairs, stretch_nodes);
        for (Index i = 0; i < ages.size(); ++i) {
            back.col(i) = weights[i] * (-ages[i] * poles_).exp() * input.col(i);
        }
        const Eigen::ArrayXXcd sums = (back.matrix() * integrals_to_nodes().transpose()).array();
        for (Index i = 0; i < ages.size(); ++i) {
            const Eigen::ArrayXcd there = (ages[i] * poles_).exp() * (now_ + sums.col(i));
            visit(from + ages[i], gauss.weight[static_cast<std::size_t>(i)] * weights[i],
                  2 * (poles_ * there + input.col(i)).real().sum());
        }
        Eigen::ArrayXcd all = now_;
        for (Index i = 0; i < ages.size(); ++i) {
            all += gauss.weight[static_cast<std::size_t>(i)] * back.col(i);
        }
        now_ = (span * poles_).exp() * all;
    }

private:
    const PointSound& sound_;
    double unit_s_;
    Eigen::ArrayXcd poles_;
    Eigen::MatrixXcd residues_;  ///< [pair][mode]
    Eigen::ArrayXcd now_;
};

}  // namespace

/// The force jumps where a contact with a dashpot closes or opens: states and kernel have to be smooth on the scale of an interval. Far away
/// the kernel lasts no more than a^2/(2 z c); one shorter than the least interval seldom meets a jump.
double longest_interval_s(const PlateResponse& response, double sound_s) noexcept {
    constexpr std::size_t coarse_pairs = 21;  // 40 poles, two of them real
    const bool fine = response.poles.size() > coarse_pairs;
    double fastest = 0;
    for (const Complex& pole : response.poles) {
        fastest = std::max(fastest, std::abs(pole));
    }
    constexpr double least_s = 1e-9;
    return std::max(least_s, std::min((fine ? 0.7 : 1.6) / fastest, sound_s / (fine ? 16 : 8)));
}

ForcedStates::ForcedStates(const PlateResponse& response, double interval_s)
    : size_(padded(response.poles.size())), columns_(2 * size_ * (1 + force_moments)) {
    const auto put = [this](std::size_t column, std::size_t pair, Complex value) {
        columns_[2 * column * size_ + pair] = value.real();
        columns_[(2 * column + 1) * size_ + pair] = value.imag();
    };
    for (std::size_t j = 0; j < response.poles.size(); ++j) {
        const Complex pole = response.poles[j];
        put(0, j, std::exp(pole * interval_s));
        std::array<Complex, force_moments> sums{};
        each_node<stretch_nodes>(0, interval_s, [&](double time, double weight) {
            const auto polynomials = legendre<force_moments>(2 * time / interval_s - 1);
            for (std::size_t q = 0; q < force_moments; ++q) {
                sums[q] += weight * polynomials[q] * std::exp(pole * (interval_s - time));
            }
        });
        for (std::size_t q = 0; q < force_moments; ++q) {
            put(1 + q, j, (2 * static_cast<double>(q) + 1) / interval_s * sums[q]);
        }
    }
}

ForceKernel::ForceKernel(const PlateResponse& response, const PointSound& sound, double interval_s,
                         double share) {
    const PlateParameters& p = response.parameters;
    const double unit_s = p.radius_m / p.fluid.sound_speed_m_per_s;
    const std::vector<double>& breaks = sound.breaks();
    const double first = sound.first() * unit_s;
    const double part = share * interval_s;
    intervals =
        static_cast<std::size_t>(std::ceil(std::max(0.0, sound.last() * unit_s - first - part) / interval_s));
    intervals += intervals % 2;
    moments.resize(intervals * moment_stride);
    Answer answer(response, sound, unit_s);
    std::size_t next_break = 1;
    const auto add = [&](double youngest, double oldest, double* row) {
        for (double from = youngest; from < oldest;) {
            while (next_break < breaks.size() && breaks[next_break] * unit_s <= from) {
                ++next_break;
            }
            const bool heard = next_break < breaks.size();
            const double to = heard ? std::min(oldest, breaks[next_break] * unit_s) : oldest;
            answer.advance(from, to, heard, [&](double age, double weight, double value) {
                const auto polynomials =
                    legendre<force_moments>(1 - 2 * (age - youngest) / (oldest - youngest));
                for (std::size_t q = 0; q < force_moments; ++q) {
                    row[q] += (2 * static_cast<double>(q) + 1) / (oldest - youngest) * weight * value *
                              polynomials[q];
                }
            });
            from = to;
        }
    };
    add(first, first + part, newest.data());
    for (std::size_t i = 0; i < intervals; ++i) {
        const double from = first + part + static_cast<double>(i) * interval_s;
        add(from, from + interval_s, moments.data() + (intervals - 1 - i) * moment_stride);
    }
    const std::size_t size = padded(response.poles.size());
    states.resize(2 * size);
    for (std::size_t j = 0; j < response.poles.size(); ++j) {
        const auto pair = static_cast<Index>(j);
        const Complex factor = 2.0 * answer.poles()[pair] * answer.now()[pair];
        states[j] = factor.real();
        states[size + j] = -factor.imag();
    }
}

}  // namespace hertzline
