#include "core/plate/force_kernel.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/plate/chebyshev.hpp"
#include "core/plate/quadrature.hpp"

namespace hertzline {

namespace {

using Complex = std::complex<double>;
using Eigen::Index;

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
    Answer(const PlateResponse& response, const SoundSum& sound, double unit_s)
        : sound_(sound.breaks(), [&](double time) -> Eigen::VectorXd { return sound(time).matrix(); }),
          unit_s_(unit_s) {
        const auto pairs = static_cast<Index>(response.poles.size());
        poles_ = Eigen::Map<const Eigen::ArrayXcd>(response.poles.data(), pairs);
        residues_.resize(pairs, static_cast<Index>(response.mode_m_per_s.size()));
        for (Index n = 0; n < residues_.cols(); ++n) {
            const Fluid& fluid = response.parameters.fluid;
            residues_.col(n) = fluid.density_kg_per_m3 * fluid.sound_speed_m_per_s *
                               response.mode_m_per_s[static_cast<std::size_t>(n)];
        }
        now_ = Eigen::ArrayXcd::Zero(pairs);
        for (Eigen::ArrayXXcd* columns : {&turns_, &weighed_turns_back_, &input_, &back_, &sums_}) {
            columns->setZero(pairs, stretch_nodes);
        }
    }

    const Eigen::ArrayXcd& poles() const noexcept { return poles_; }
    const Eigen::ArrayXcd& now() const noexcept { return now_; }

    /// Goes on over a stretch in which the kernel is smooth. Calls visit(age, weight, answer) for the nodes of an integral.
    /// @param from age, span [s] @param heard whether sound arrives then
    template <class Visit>
    void advance(double from, double span, bool heard, Visit visit) {
        const GaussNodes<stretch_nodes>& gauss = gauss_nodes<stretch_nodes>();
        look_at(span);
        input_.setZero();
        for (Index i = 0; heard && i < ages_.size(); ++i) {
            input_.col(i) =
                (residues_ * sound_((from + ages_[i]) / unit_s_).head(residues_.cols()).matrix()).array();
        }
        // in a frame in which the states stand still
        back_ = weighed_turns_back_ * input_;
        sums_.matrix().noalias() = back_.matrix() * integrals_to_nodes().transpose();
        for (Index i = 0; i < ages_.size(); ++i) {
            values_[i] = 2 * (poles_ * (turns_.col(i) * (now_ + sums_.col(i))) + input_.col(i)).real().sum();
            visit(from + ages_[i], gauss.weight[static_cast<std::size_t>(i)] * weights_[i], values_[i]);
        }
        for (Index i = 0; i < ages_.size(); ++i) {
            now_ += gauss.weight[static_cast<std::size_t>(i)] * back_.col(i);
        }
        now_ *= turn_;
    }

    /// Integrals of the answer over the last stretch, from its begin to each of its nodes.
    Eigen::VectorXd integrals() const { return integrals_to_nodes() * (weights_ * values_).matrix(); }

private:
    /// The nodes of a stretch and what the states do until there: most stretches are as long as the one before.
    void look_at(double span) {
        if (span == span_) {
            return;
        }
        span_ = span;
        const GaussNodes<stretch_nodes>& gauss = gauss_nodes<stretch_nodes>();
        for (Index i = 0; i < ages_.size(); ++i) {
            const SmoothStep step = smooth_step(0.5 * (1 + gauss.node[static_cast<std::size_t>(i)]));
            ages_[i] = span * step.value;
            weights_[i] = 0.5 * span * step.slope;
            turns_.col(i) = (ages_[i] * poles_).exp();
            weighed_turns_back_.col(i) = weights_[i] * (-ages_[i] * poles_).exp();
        }
        turn_ = (span * poles_).exp();
    }

    TableBetween sound_;
    double unit_s_;
    double span_ = 0;
    Eigen::ArrayXd ages_{Eigen::ArrayXd(stretch_nodes)}, weights_{Eigen::ArrayXd(stretch_nodes)};
    Eigen::ArrayXd values_{Eigen::ArrayXd(stretch_nodes)};
    Eigen::ArrayXXcd turns_, weighed_turns_back_, input_, back_, sums_;
    Eigen::ArrayXcd turn_;
    Eigen::ArrayXcd poles_;
    Eigen::MatrixXcd residues_;  ///< [pair][mode]
    Eigen::ArrayXcd now_;
};

/// Chebyshev's coefficients of the polynomials that are 1 at one node and 0 at the others, [node][degree].
const Eigen::MatrixXd& series_of_nodes() {
    static const Eigen::MatrixXd matrix =
        chebyshev(stretch_nodes, stretch_nodes, [](double x) -> Eigen::VectorXd {
            const GaussNodes<stretch_nodes>& gauss = gauss_nodes<stretch_nodes>();
            const auto at = legendre<stretch_nodes>(2 * x - 1);
            Eigen::VectorXd values = Eigen::VectorXd::Zero(stretch_nodes);
            for (std::size_t k = 0; k < stretch_nodes; ++k) {
                const auto at_node = legendre<stretch_nodes>(gauss.node[k]);
                for (std::size_t q = 0; q < stretch_nodes; ++q) {
                    values[static_cast<Index>(k)] +=
                        (static_cast<double>(q) + 0.5) * gauss.weight[k] * at_node[q] * at[q];
                }
            }
            return values;
        });
    return matrix;
}

/// Collects the parts of the answer to a jump that moments lack.
class JumpRests {
public:
    void begin_interval(double from, double length) {
        begin_ = parts_.size();
        from_ = from;
        length_ = length;
        so_far_ = 0;
    }

    /// @param from, to ends of a stretch [intervals] @param integrals from its begin to each node
    void add(double from, double to, const Eigen::VectorXd& integrals) {
        parts_.push_back({from, to, integrals.array() + so_far_});
        so_far_ += (series_of_nodes().transpose() * integrals)
                       .sum();  // all of Chebyshev's polynomials are 1 at the end
    }

    /// @param row factors of the interval's moments @param length_s of it
    void end_interval(const double* row, double length_s) {
        const GaussNodes<stretch_nodes>& gauss = gauss_nodes<stretch_nodes>();
        for (std::size_t i = begin_; i < parts_.size(); ++i) {
            Part& part = parts_[i];
            for (std::size_t k = 0; k < stretch_nodes; ++k) {
                const double age =
                    part.from + (part.to - part.from) * smooth_step(0.5 * (1 + gauss.node[k])).value;
                // the moments' polynomials run from the old end to the young one: their integrals from y to 1
                const double y = 1 - 2 * (age - from_) / length_;
                const auto p = legendre<force_moments + 1>(y);
                double& rest = part.rest[static_cast<Index>(k)];
                rest -= 0.5 * length_s * row[0] * (1 - y);
                for (std::size_t q = 1; q < force_moments; ++q) {
                    rest +=
                        0.5 * length_s / (2 * static_cast<double>(q) + 1) * row[q] * (p[q + 1] - p[q - 1]);
                }
            }
        }
        largest_ = std::max(largest_, std::abs(so_far_));
    }

    std::vector<JumpRest> steep() const {
        const double negligible = 1e-8 * largest_;
        std::vector<JumpRest> found;
        for (const Part& part : parts_) {
            if (part.rest.abs().maxCoeff() > negligible) {
                const Eigen::VectorXd series = series_of_nodes().transpose() * part.rest.matrix();
                Index terms = series.size();
                for (double left_out = 0;
                     terms > 1 && (left_out += std::abs(series[terms - 1])) < 0.1 * negligible;) {
                    --terms;
                }
                found.push_back({part.from, part.to, {series.begin(), series.begin() + terms}});
            }
        }
        return found;
    }

private:
    /// A stretch in which a kernel is smooth.
    struct Part {
        double from, to;  ///< ages after the first sound [intervals]
        Eigen::ArrayXd
            rest;  ///< at each node; until the end of the interval its integral from there on [Pa/N]
    };
    std::vector<Part> parts_;
    std::size_t begin_ = 0;  ///< of the open interval's
    double from_ = 0, length_ = 0;
    double so_far_ = 0;   ///< of the interval's integral
    double largest_ = 0;  ///< integral over an interval
};

}  // namespace

double ForceKernel::rest_of_jump(double age) const noexcept {
    const auto after = std::ranges::upper_bound(steep, age, {}, &JumpRest::from);
    if (after == steep.begin() || age >= std::prev(after)->to) {
        return 0;
    }
    const JumpRest& part = *std::prev(after);
    const double x = inverse_smooth_step((age - part.from) / (part.to - part.from));
    return clenshaw(std::ssize(part.series), x, 0.0,
                    [&part](Index q) { return part.series[static_cast<std::size_t>(q)]; });
}

/// States and kernel are smooth on the scale of an interval but near the first and last sounds, which jumps of the force show (ForceKernel::
/// steep). Pressures err by less than 1e-6 with the coarse intervals, by 1e-7 with the fine ones. Far away a kernel lasts no more than
/// a^2/(2 z c).
double longest_interval_s(const PlateResponse& response, double sound_s) noexcept {
    constexpr std::size_t coarse_pairs = 21;  // 40 poles, two of them real
    const bool fine = response.poles.size() > coarse_pairs;
    double fastest = 0;
    for (const Complex& pole : response.poles) {
        fastest = std::max(fastest, std::abs(pole));
    }
    constexpr double least_s = 1e-9;
    return std::max(least_s, std::min((fine ? 1.4 : 2.0) / fastest, sound_s / (fine ? 8 : 4)));
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

ForceKernel::ForceKernel(const PlateResponse& response, const SoundSum& sound, double interval_s,
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
    JumpRests rests;
    const auto add = [&](double youngest, double length, double* row) {
        const double oldest = youngest + length;
        rests.begin_interval((youngest - first) / interval_s, length / interval_s);
        for (double from = youngest; from < oldest;) {
            while (next_break < breaks.size() && breaks[next_break] * unit_s <= from) {
                ++next_break;
            }
            const bool heard = next_break < breaks.size();
            const double to = heard ? std::min(oldest, breaks[next_break] * unit_s) : oldest;
            const double span = from == youngest && to == oldest ? length : to - from;
            answer.advance(from, span, heard, [&](double age, double weight, double value) {
                const auto polynomials =
                    legendre<force_moments>(1 - 2 * (age - youngest) / (oldest - youngest));
                for (std::size_t q = 0; q < force_moments; ++q) {
                    row[q] += (2 * static_cast<double>(q) + 1) / (oldest - youngest) * weight * value *
                              polynomials[q];
                }
            });
            rests.add((from - first) / interval_s, (to - first) / interval_s, answer.integrals());
            from = to;
        }
        rests.end_interval(row, length);
    };
    add(first, part, newest.data());
    for (std::size_t i = 0; i < intervals; ++i) {
        const double from = first + part + static_cast<double>(i) * interval_s;
        add(from, interval_s, moments.data() + (intervals - 1 - i) * moment_stride);
    }
    steep = rests.steep();
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
