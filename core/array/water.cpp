#include "core/array/water.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "core/plate/chebyshev.hpp"
#include "core/plate/disc_pair.hpp"
#include "core/plate/lagrange.hpp"
#include "core/plate/point_sound.hpp"
#include "core/plate/quadrature.hpp"

namespace hertzline {

namespace {

using Complex = std::complex<double>;
using Eigen::Index;

constexpr std::int64_t window_lines = 4;
constexpr double window_per_step = 0.8;
constexpr Index force_lines = 6;  // that the force is a polynomial through

/// A part of the chains' longest step. In the longest interval the shortest wave that discs send each other turns by less than half a
/// radian: its displacement is a polynomial over eight of them. The shortest leaves nothing to be gained.
double interval_s(const PlateParameters& p, double step_s) {
    constexpr double turn = 0.4;
    constexpr double shortest = 0.05;
    const double longest_s = turn / disc_modes(p).back().root() * p.radius_m / p.fluid.sound_speed_m_per_s;
    return std::clamp(window_per_step * step_s / static_cast<double>(window_lines), shortest * longest_s,
                      longest_s);
}

/// Equal intervals of that length, but for three per cent.
TimeGrid grid_for(double interval_s, double sample_period_s) noexcept {
    constexpr double least = 16;
    double samples = interval_s / sample_period_s;
    std::int64_t intervals = 1;
    while (samples < least) {
        samples *= 2;
        intervals *= 2;
    }
    return {std::llround(samples), intervals, sample_period_s};
}

}  // namespace

Water::Plate::Plate(const PlateResponse& of, double interval_s) : response(of), modes(mode_response(of)) {
    const auto pairs = static_cast<Index>(of.poles.size());
    constexpr Index whole = numbers_at_once / 2;
    const Index padded = (pairs + whole - 1) / whole * whole;
    const auto count = static_cast<Index>(of.modes.size());
    turn = Eigen::ArrayXcd::Zero(padded);
    answers = Eigen::ArrayXXcd::Zero(padded, force_lines);
    for (Index j = 0; j < pairs; ++j) {
        const Complex pole = of.poles[static_cast<std::size_t>(j)];
        turn[j] = std::exp(pole * interval_s);
        constexpr std::size_t nodes = 24;
        each_node<nodes>(0, 1, [&](double x, double weight) {
            for (Index l = 0; l < force_lines; ++l) {
                double share = 1;
                for (Index k = 0; k < force_lines; ++k) {
                    if (k != l) {
                        share *= (x + static_cast<double>(force_lines - 2 - k)) / static_cast<double>(l - k);
                    }
                }
                answers(j, l) += weight * interval_s * share * std::exp(pole * interval_s * (1 - x));
            }
        });
    }
    rows = RowMajor::Zero(3 * count, 2 * padded * count);
    at_once = Eigen::MatrixXd::Zero(count, count);
    for (Index n = 0; n < count; ++n) {
        for (Index m = 0; m < count; ++m) {
            const Eigen::VectorXcd& residues = modes->m_per_s[static_cast<std::size_t>(pair_of(m, n))];
            for (Index j = 0; j < pairs; ++j) {
                const Complex pole = of.poles[static_cast<std::size_t>(j)];
                const std::array<Complex, 3> of_state{residues[j] / pole, residues[j], residues[j] * pole};
                for (Index kind = 0; kind < 3; ++kind) {
                    rows(kind * count + n, 2 * (m * padded + j)) =
                        2 * of_state[static_cast<std::size_t>(kind)].real();
                    rows(kind * count + n, 2 * (m * padded + j) + 1) =
                        -2 * of_state[static_cast<std::size_t>(kind)].imag();
                }
            }
            at_once(n, m) = 2 * residues.real().sum();
        }
    }
}

Water::Water(const Scene& scene, std::vector<const PlateResponse*> responses, double step_s, double part,
             const std::vector<std::array<double, 3>>& points, const kernels::SeriesKernels& kernels)
    : kernels_(kernels),
      grid_(grid_for(part * interval_s(responses.front()->parameters, step_s),
                     1 / scene.output.sample_rate_hz)),
      modes_(static_cast<Index>(responses.front()->modes.size())) {
    const PlateParameters& p = responses.front()->parameters;
    const double a = p.radius_m;
    const double c = p.fluid.sound_speed_m_per_s;
    const double interval = grid_.interval_s() * c / a;
    scale_ = p.fluid.density_kg_per_m3 * c * c * a;
    const std::vector<DiscMode> shapes_of_modes = disc_modes(p);
    const std::size_t count = responses.size();

    std::vector<double> distances;  // the distinct ones
    memory_of_ = Eigen::MatrixXi::Constant(static_cast<Index>(count), static_cast<Index>(count), -1);
    for (std::size_t i = 0; i < count; ++i) {
        for (std::size_t j = 0; j < count; ++j) {
            if (i == j) {
                continue;
            }
            const double d =
                std::hypot(scene.array.x_m[i] - scene.array.x_m[j], scene.array.y_m[i] - scene.array.y_m[j]) /
                a;
            const auto same = std::find_if(distances.begin(), distances.end(),
                                           [d](double other) { return std::abs(other - d) < 1e-9 * d; });
            memory_of_(static_cast<Index>(i), static_cast<Index>(j)) =
                static_cast<int>(same - distances.begin());
            if (same == distances.end()) {
                distances.push_back(std::max(2.0, d));
            }
        }
    }
    const ModeCorrelation correlation(shapes_of_modes);
    std::int64_t longest = 1;
    for (const double d : distances) {
        const PairMemory memory(correlation, d);
        memories_.push_back(
            interval_weights({memory.first(), d, memory.last()}, interval, modes_, modes_, [&](double s) {
                const Eigen::VectorXd k = memory(s);
                Eigen::MatrixXd all(modes_, modes_);
                for (Index m = 0; m < modes_; ++m) {
                    for (Index n = 0; n < modes_; ++n) {
                        all(m, n) = k[pair_of(m, n)];
                    }
                }
                return all;
            }));
        longest = std::max(longest, memories_.back().newest + rows_of(memories_.back(), modes_));
    }

    // the plates: equal ones share their tables
    const ShapeTable shapes(shapes_of_modes);
    for (std::size_t i = 0; i < count; ++i) {
        const auto same = std::find_if(plates_.begin(), plates_.end(),
                                       [&](const auto& plate) { return &plate->response == responses[i]; });
        const bool is_new = same == plates_.end();
        if (is_new) {
            plates_.push_back(std::make_shared<const Plate>(*responses[i], grid_.interval_s()));
        }
        std::vector<IntervalWeights> sounds;
        std::int64_t longest_sound = 1;
        for (const auto& [x, y, z] : points) {
            const PointSound sound(shapes, std::hypot(x - scene.array.x_m[i], y - scene.array.y_m[i]) / a,
                                   z / a);
            const TableBetween table(sound.breaks(),
                                     [&](double s) -> Eigen::VectorXd { return sound(s).matrix(); });
            sounds.push_back(interval_weights(
                sound.breaks(), interval, 1, modes_,
                [&](double s) -> Eigen::MatrixXd { return table(s).head(modes_).transpose(); }));
            sounds.back().weights *= p.fluid.density_kg_per_m3 * a;  // rho c, for an integral over a/c
            longest_sound = std::max(longest_sound, sounds.back().newest + rows_of(sounds.back(), modes_));
        }
        const auto modes = static_cast<std::size_t>(modes_);
        const auto more = static_cast<std::size_t>(3 * window_lines);
        const auto waiting =
            static_cast<std::size_t>(most_asked * grid_.intervals / grid_.samples) + 2 * more;
        elements_.push_back(std::make_unique<Element>(
            Element{.plate = is_new ? plates_.back() : *same,
                    .disc = std::make_unique<DiscInWater>(*responses[i], grid_, kernels, window_lines),
                    .groups = {},
                    .sounds = std::move(sounds),
                    .modes = RowHistory(modes, static_cast<std::size_t>(longest) + more),
                    .accelerations = RowHistory(modes, static_cast<std::size_t>(longest_sound) + more),
                    .forces = RowHistory(modes, static_cast<std::size_t>(force_lines) + more),
                    .outputs = RowHistory(1 + points.size(), waiting),
                    .states = {},
                    .row = std::vector<double>(1 + points.size()),
                    .heard = Eigen::VectorXd(longest * modes_),
                    .force = Eigen::VectorXd(modes_),
                    .out = Eigen::VectorXd(3 * modes_),
                    .both = Eigen::VectorXd(2 * modes_),
                    .added = {}}));
        Element& element = *elements_.back();
        element.states.resize(element.plate->turn.size(), modes_);
        element.added.assign(static_cast<std::size_t>(window_lines), Eigen::VectorXd(2 * modes_));
        for (std::size_t memory = 0; memory < memories_.size(); ++memory) {
            Group group{memory, {}};
            for (std::size_t j = 0; j < count; ++j) {
                if (memory_of_(static_cast<Index>(i), static_cast<Index>(j)) == static_cast<int>(memory)) {
                    group.elements.push_back(j);
                }
            }
            if (!group.elements.empty()) {
                element.groups.push_back(std::move(group));
            }
        }
    }

    // value, slope and curvature at the window's begin, middle and end
    Eigen::Matrix<double, DiscInWater::window_terms, DiscInWater::window_terms> at;
    for (Index node = 0; node < 3; ++node) {
        const double x = 0.5 * static_cast<double>(node);
        for (Index n = 0; n < at.cols(); ++n) {
            const auto degree = static_cast<double>(n);
            at(3 * node, n) = std::pow(x, n);
            at(3 * node + 1, n) = n < 1 ? 0 : degree * std::pow(x, n - 1);
            at(3 * node + 2, n) = n < 2 ? 0 : degree * (degree - 1) * std::pow(x, n - 2);
        }
    }
    hermite_ = at.inverse();
    reset();
}

void Water::reset() noexcept {
    line_ = 0;
    for (const auto& element : elements_) {
        element->disc->reset();
        for (RowHistory* history :
             {&element->modes, &element->accelerations, &element->forces, &element->outputs}) {
            history->clear();
        }
        element->states.setZero();
        for (Eigen::VectorXd& added : element->added) {
            added.setZero();
        }
        element->held = element->lost = element->loss_rate = 0;
    }
}

void Water::begin_window(std::size_t number) noexcept {
    Element& element = *elements_[number];
    const Plate& plate = *element.plate;
    const double length_s = static_cast<double>(window_lines) * grid_.interval_s();
    Eigen::Matrix<double, DiscInWater::window_terms, 1> nodes;
    const auto put_node = [&](Index node, double x, double v, double acceleration) {
        nodes.segment<3>(3 * node) << x, v * length_s, acceleration * length_s * length_s;
    };
    const Eigen::VectorXd& last = element.added.back();
    put_node(0, last.head(modes_).sum(), last.tail(modes_).sum(),
             element.accelerations.up_to(line_, 1).sum());
    Eigen::VectorXd& out = element.out;
    Eigen::VectorXd& force = element.force;
    const auto product = [this](const RowMajor& rows, Index row, const double* numbers) {
        return kernels_.sum_of_products(rows.row(row).data(), numbers, static_cast<std::size_t>(rows.cols()));
    };
    for (std::int64_t l = 1; l <= window_lines; ++l) {
        const std::int64_t line = line_ + l;
        force.setZero();
        for (const Group& group : element.groups) {
            const IntervalWeights& memory = memories_[group.memory];
            const std::int64_t rows = rows_of(memory, modes_);
            auto heard = element.heard.head(rows * modes_);
            heard = elements_[group.elements.front()]->modes.up_to(line - memory.newest, rows);
            for (std::size_t j = 1; j < group.elements.size(); ++j) {
                heard += elements_[group.elements[j]]->modes.up_to(line - memory.newest, rows);
            }
            for (Index m = 0; m < modes_; ++m) {
                force[m] -= scale_ * product(memory.weights, m, heard.data());
            }
        }
        element.forces.put(line, force.data());
        const auto forces = element.forces.up_to(line, force_lines);
        for (Index m = 0; m < modes_; ++m) {
            auto state = element.states.col(m).array();
            state *= plate.turn;
            for (Index k = 0; k < force_lines; ++k) {
                state += plate.answers.col(k) * forces[k * modes_ + m];
            }
        }
        const auto* const states = reinterpret_cast<const double*>(element.states.data());
        for (Index row = 0; row < out.size(); ++row) {
            out[row] = product(plate.rows, row, states);
        }
        out.tail(modes_).noalias() += plate.at_once * force;
        element.accelerations.put(line, out.data() + 2 * modes_);
        element.added[static_cast<std::size_t>(l - 1)] = out.head(2 * modes_);
        if (2 * l == window_lines || l == window_lines) {
            put_node(2 * l == window_lines ? 1 : 2, out.head(modes_).sum(), out.segment(modes_, modes_).sum(),
                     out.tail(modes_).sum());
        }
        double face = 0;
        for (Index n = 0; n < modes_; ++n) {
            face += plate.response.modes[static_cast<std::size_t>(n)].mean * out[modes_ + n];
        }
        element.row[0] = face;
        for (std::size_t point = 0; point < element.sounds.size(); ++point) {
            const IntervalWeights& sound = element.sounds[point];
            element.row[1 + point] =
                product(sound.weights, 0,
                        element.accelerations.up_to(line - sound.newest, rows_of(sound, modes_)).data());
        }
        element.outputs.put(line, element.row.data());
    }
    const Eigen::Matrix<double, DiscInWater::window_terms, 1> terms = hermite_ * nodes;
    DiscInWater::Window window;
    std::copy_n(terms.data(), window.size(), window.begin());
    element.disc->carry(window, window_lines);
}

void Water::end_window(std::size_t number) noexcept {
    Element& element = *elements_[number];
    const std::vector<PlateMode>& modes = element.plate->response.modes;
    Eigen::VectorXd& both = element.both;
    for (std::int64_t l = 1; l <= window_lines; ++l) {
        both = element.added[static_cast<std::size_t>(l - 1)] +
               Eigen::Map<const Eigen::VectorXd>(element.disc->own_modes(l), 2 * modes_);
        element.modes.put(line_ + l, both.data());
        double rate = 0;
        for (Index n = 0; n < modes_; ++n) {
            rate += modes[static_cast<std::size_t>(n)].loss_kg_per_s * both[modes_ + n] * both[modes_ + n];
        }
        element.lost += 0.5 * grid_.interval_s() * (element.loss_rate + rate);
        element.loss_rate = rate;
    }
    element.held = 0;
    for (Index n = 0; n < modes_; ++n) {
        const PlateMode& mode = modes[static_cast<std::size_t>(n)];
        element.held += 0.5 * (mode.stiffness_n_per_m * both[n] * both[n] +
                               mode.mass_kg * both[modes_ + n] * both[modes_ + n]);
    }
    // discs that nearly touch hear the first sound from within the next window: its force is small, and is extrapolated
    const std::int64_t end = line_ + window_lines;
    const auto now = element.modes.up_to(end, 1);
    const auto before = element.modes.up_to(end - 1, 1);
    const auto earlier = element.modes.up_to(end - 2, 1);
    for (std::int64_t l = 1; l <= window_lines; ++l) {
        const auto t = static_cast<double>(l);
        both.head(modes_) = now + t * (now - before) + 0.5 * t * (t + 1) * (now - 2 * before + earlier);
        element.modes.put(end + l, both.data());
    }
}

void Water::next_window() noexcept {
    line_ += window_lines;
}

double Water::output(const Element& element, std::size_t number, std::int64_t sample) const noexcept {
    const std::int64_t all = sample * grid_.intervals;
    const std::int64_t line = all / grid_.samples;
    const auto rest = static_cast<double>(all % grid_.samples);
    const auto numbers = static_cast<Index>(1 + element.sounds.size());
    if (rest == 0) {
        return element.outputs.up_to(line, 1)[static_cast<Index>(number)];
    }
    const LagrangeWeights weights = lagrange(rest / static_cast<double>(grid_.samples));
    const auto rows = element.outputs.up_to(line + lagrange_after, static_cast<std::int64_t>(weights.size()));
    double sum = 0;
    for (std::size_t i = 0; i < weights.size(); ++i) {
        sum += weights[i] * rows[static_cast<Index>(i) * numbers + static_cast<Index>(number)];
    }
    return sum;
}

double Water::face(std::size_t element, std::int64_t sample) const noexcept {
    return output(*elements_[element], 0, sample);
}

double Water::pressure(std::size_t point, std::int64_t sample) const noexcept {
    double sum = 0;
    for (const auto& element : elements_) {
        sum += output(*element, 1 + point, sample);
    }
    return sum;
}

std::int64_t Water::last_sample() const noexcept {
    return line_ < lagrange_after ? -1 : (line_ - lagrange_after) * grid_.samples / grid_.intervals;
}

double Water::fit_error() const noexcept {
    constexpr double share =
        0.5;  // of what a disc does is done by others: hexagons at the closest pitch show 0.4 of it at most
    double worst = 0;
    for (const auto& plate : plates_) {
        worst = std::max(worst, plate->modes->error);
    }
    return share * worst;
}

/// Of all modes of all discs [kg/s].
Eigen::MatrixXcd Water::impedances(double frequency_hz, bool alone) const {
    const double omega = 2 * std::numbers::pi * frequency_hz;
    const auto count = static_cast<Index>(elements_.size());
    Eigen::MatrixXcd all = Eigen::MatrixXcd::Zero(count * modes_, count * modes_);
    for (Index i = 0; i < count; ++i) {
        const Plate& plate = *elements_[static_cast<std::size_t>(i)]->plate;
        Eigen::MatrixXcd mobility(modes_, modes_);
        for (Index n = 0; n < modes_; ++n) {
            for (Index m = 0; m < modes_; ++m) {
                mobility(n, m) = value_at(plate.response.poles,
                                          plate.modes->m_per_s[static_cast<std::size_t>(pair_of(m, n))],
                                          Complex(0, omega));
            }
        }
        all.block(i * modes_, i * modes_, modes_, modes_) = mobility.inverse();
    }
    if (alone) {
        return all;
    }
    std::vector<Eigen::MatrixXcd> between;
    for (const IntervalWeights& memory : memories_) {
        Eigen::MatrixXcd sum = Eigen::MatrixXcd::Zero(modes_, modes_);
        const std::int64_t rows = rows_of(memory, modes_);
        for (std::int64_t row = 0; row < rows; ++row) {
            const double age_s = static_cast<double>(memory.newest + rows - 1 - row) * grid_.interval_s();
            sum += std::polar(1.0, -omega * age_s) * memory.weights.middleCols(row * modes_, modes_);
        }
        between.emplace_back(scale_ / Complex(0, omega) * sum);
    }
    for (Index i = 0; i < count; ++i) {
        for (Index j = 0; j < count; ++j) {
            if (i != j) {
                all.block(i * modes_, j * modes_, modes_, modes_) =
                    between[static_cast<std::size_t>(memory_of_(i, j))];
            }
        }
    }
    return all;
}

/// Velocities under the contacts per force of each contact [m/(N s)].
Eigen::MatrixXcd Water::mobilities(double frequency_hz, bool alone) const {
    const auto count = static_cast<Index>(elements_.size());
    Eigen::MatrixXcd contacts = Eigen::MatrixXcd::Zero(count * modes_, count);
    for (Index i = 0; i < count; ++i) {
        contacts.block(i * modes_, i, modes_, 1).setOnes();
    }
    return contacts.transpose() * impedances(frequency_hz, alone).partialPivLu().solve(contacts);
}

Water::Passivity Water::passivity() const {
    constexpr int frequencies = 60;
    constexpr double lowest_hz = 2e3;
    const double highest_hz = 0.2 / grid_.interval_s();
    Passivity found{.least_resistance = 1};
    for (int i = 0; i <= frequencies; ++i) {
        const Eigen::MatrixXcd all = mobilities(
            lowest_hz * std::pow(highest_hz / lowest_hz, static_cast<double>(i) / frequencies), false);
        const Eigen::VectorXd eigenvalues = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXcd>(
                                                0.5 * (all + all.adjoint()), Eigen::EigenvaluesOnly)
                                                .eigenvalues();
        found.least_resistance = std::min(found.least_resistance, eigenvalues.minCoeff() / all.norm());
        found.asymmetry = std::max(found.asymmetry, (all - all.transpose()).norm() / all.norm());
    }
    return found;
}

double Water::change_at(double frequency_hz) const {
    const auto count = static_cast<Index>(elements_.size());
    const Eigen::VectorXcd forces = Eigen::VectorXcd::Ones(count);
    const Eigen::ArrayXcd together = mobilities(frequency_hz, false) * forces;
    const Eigen::ArrayXcd alone = mobilities(frequency_hz, true) * forces;
    return (together / alone - 1).abs().maxCoeff();
}

}  // namespace hertzline
