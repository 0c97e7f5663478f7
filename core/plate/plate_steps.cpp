#include "core/plate/plate_steps.hpp"

#include <algorithm>
#include <cmath>
#include <complex>

namespace hertzline {

namespace {

using Complex = std::complex<double>;

/// phi_0(z) = exp(z) and z phi_(n+1)(z) = phi_n(z) - 1/n!, up to phi_4.
std::array<Complex, 5> phi_functions(Complex z) noexcept {
    constexpr std::array inverse_factorial{1.0, 1.0, 1.0 / 2, 1.0 / 6, 1.0 / 24};
    constexpr std::size_t last = inverse_factorial.size() - 1;
    std::array<Complex, last + 1> phi{std::exp(z)};
    constexpr double small = 2;
    if (std::abs(z) >= small) {
        for (std::size_t n = 0; n < last; ++n) {
            phi[n + 1] = (phi[n] - inverse_factorial[n]) / z;
        }
        return phi;
    }
    constexpr int terms = 20;
    Complex sum = 1;  // of z^k 4!/(k + 4)!, the last term first
    for (int k = terms; k > 0; --k) {
        sum = 1.0 + sum * z / (k + static_cast<double>(last));
    }
    phi[last] = sum * inverse_factorial[last];
    for (std::size_t n = last - 1; n > 0; --n) {
        phi[n] = z * phi[n + 1] + inverse_factorial[n];
    }
    return phi;
}

/// Complex numbers, real parts before imaginary ones.
void put(Eigen::ArrayXd& numbers, Eigen::Index i, Complex value) noexcept {
    numbers[i] = value.real();
    numbers[numbers.size() / 2 + i] = value.imag();
}

/// Hermite's rule: from values and slopes at both ends.
double integral(double time, double from, double slope, double to, double slope_there) noexcept {
    return time * (0.5 * (from + to) + time / 12 * (slope - slope_there));
}

}  // namespace

PlateSteps::PlateSteps(const PlateResponse& response, double step_s, PlateListener* listener)
    : response_(response), step_s_(step_s), listener_(listener), body_(body_rows, 2 * pairs()) {
    Eigen::VectorXcd poles(pairs());
    std::copy(response.poles.begin(), response.poles.end(), poles.begin());
    const Eigen::VectorXcd reaction = response.centre_m_per_s.cwiseProduct(poles);
    body_.row(displacement_row) = row_of(response.centre_m);
    body_.row(velocity_row) = row_of(response.centre_m_per_s);
    body_.row(reaction_row) = row_of(reaction);
    memory_1_ = 2 * reaction.real().sum();
    memory_2_ = 2 * reaction.cwiseProduct(poles).real().sum();
    const auto modes = static_cast<Eigen::Index>(PlatePart::most_modes);
    mode_displacements_ = mode_velocities_ = mode_reactions_ = Eigen::MatrixXd::Zero(modes, 2 * pairs());
    for (std::size_t n = 0; n < response.modes.size(); ++n) {
        const auto row = static_cast<Eigen::Index>(n);
        mode_displacements_.row(row) = row_of(response.mode_m[n]);
        mode_velocities_.row(row) = row_of(response.mode_m_per_s[n]);
        mode_reactions_.row(row) = row_of(response.mode_m_per_s[n].cwiseProduct(poles));
        at_once_[row] = 2 * response.mode_m_per_s[n].real().sum();
        loss_[row] = response.modes[n].loss_kg_per_s;
    }
    for (Flow* const flow : {&half_step_, &other_}) {
        flow->factor.setZero(2 * pairs());
        flow->answer.fill(flow->factor);
        make(*flow, 0.5 * step_s);
    }
    begin_.y = now_.y = Eigen::ArrayXd::Zero(2 * pairs());
    reset();
}

/// An output is twice the real part of the sum of residues times states.
Eigen::VectorXd PlateSteps::row_of(const Eigen::VectorXcd& residues) const {
    Eigen::VectorXd row(2 * pairs());
    row << 2 * residues.real(), -2 * residues.imag();
    return row;
}

void PlateSteps::make(Flow& flow, double time) const noexcept {
    flow.time = time;
    for (Eigen::Index j = 0; j < pairs(); ++j) {
        const auto phi = phi_functions(time * response_.poles[static_cast<std::size_t>(j)]);
        put(flow.factor, j, phi[0]);
        for (std::size_t n = 0; n < flow.answer.size(); ++n) {
            put(flow.answer[n], j, phi[n + 1]);
        }
    }
}

const PlateSteps::Flow& PlateSteps::flow(double time) noexcept {
    if (time == half_step_.time) {
        return half_step_;
    }
    if (time != other_.time) {
        make(other_, time);
    }
    return other_;
}

void PlateSteps::reset() noexcept {
    begin_.y.setZero();
    begin_.body.setZero();
    begin_.velocity = begin_.acceleration = Modes::Zero();
    begin_.passing = begin_.passing_dot = begin_.kicked = 0;
    now_ = begin_;
    passed_ = lost_ = 0;
    moment_ = {};
}

void PlateSteps::enter(std::int64_t step) noexcept {
    if (step != moment_.step) {
        moment_ = {step, 0};
    }
}

void PlateSteps::kick(double velocity) noexcept {
    const double before = now_.body[velocity_row];
    const double impulse = (velocity - before) / response_.mobility;
    now_.y.head(pairs()) += impulse;
    now_.kicked += impulse * 0.5 * (before + velocity);
    now_.body[velocity_row] = velocity;
    now_.body[reaction_row] += memory_1_ * impulse;
}

void PlateSteps::begin_drift(double time) noexcept {
    present_ = &flow(time);
    const Eigen::Index n = pairs();
    const Eigen::ArrayXd& factor = present_->factor;
    for (Eigen::Index j = 0; j < n; ++j) {
        const double re = now_.y[j];
        const double im = now_.y[n + j];
        now_.y[j] = factor[j] * re - factor[n + j] * im;
        now_.y[n + j] = factor[n + j] * re + factor[j] * im;
    }
    const double v0 = now_.body[velocity_row];
    const double slope0 = time * now_.body[reaction_row];
    now_.body.noalias() = body_ * now_.y.matrix();
    // the cubic through values and slopes of the body's velocity at both ends
    const double v1 = now_.body[velocity_row];
    const double slope1 = time * now_.body[reaction_row];
    free_ = {v0, slope0, 2 * (3 * (v1 - v0) - 2 * slope0 - slope1), 6 * (2 * (v0 - v1) + slope0 + slope1), 0};
    impulses_.fill(0);
}

double PlateSteps::derivative(int power, double by_dashpot) noexcept {
    const auto p = static_cast<std::size_t>(power);
    impulses_[p - 1] = by_dashpot / response_.mobility;
    double behind = free_[p];
    if (p >= 2) {
        behind += present_->time * memory_1_ * impulses_[p - 2];
    }
    if (p >= 3) {
        behind += present_->time * present_->time * memory_2_ * impulses_[p - 3];
    }
    return behind;
}

void PlateSteps::end_drift() noexcept {
    if (std::all_of(impulses_.begin(), impulses_.end(), [](double impulse) { return impulse == 0; })) {
        return;
    }
    for (std::size_t n = 0; n < impulses_.size(); ++n) {
        now_.y += impulses_[n] * present_->answer[n];
    }
    now_.body.noalias() = body_ * now_.y.matrix();
}

void PlateSteps::observe(At at, const Drive& drive) noexcept {
    State& state = this->state(at);
    state.velocity.matrix().noalias() = mode_velocities_ * state.y.matrix();
    state.acceleration.matrix().noalias() = mode_reactions_ * state.y.matrix();
    state.acceleration += drive.force * at_once_;
    state.passing = drive.force * drive.velocity;
    state.passing_dot = drive.force_dot * drive.velocity + drive.force * drive.acceleration;
}

void PlateSteps::kick_between_steps(double velocity) noexcept {
    begin();
    kick(velocity);
    now_.kicked = 0;
    begin_ = now_;
}

void PlateSteps::accept(double time) noexcept {
    passed_ += integral(time, begin_.passing, begin_.passing_dot, now_.passing, now_.passing_dot);
    finish(time);
}

void PlateSteps::accept_kicked(double time) noexcept {
    passed_ += now_.kicked;
    finish(time);
}

void PlateSteps::finish(double time) noexcept {
    const auto loss = [this](const State& at) { return (loss_ * at.velocity.square()).sum(); };
    const auto slope = [this](const State& at) { return 2 * (loss_ * at.velocity * at.acceleration).sum(); };
    lost_ += integral(time, loss(begin_), slope(begin_), loss(now_), slope(now_));
    constexpr double sliver = 2e-9;  // of a step, which its last part may lack
    const double reached = moment_.fraction + time / step_s_;
    const StepMoment from = moment_;
    moment_.fraction = reached > 1 - sliver ? 1 : reached;
    if (listener_ != nullptr) {
        tell(from, time);
    }
    now_.kicked = 0;
    begin_ = now_;
}

/// The cubics through the modes' velocities and accelerations at both ends.
void PlateSteps::tell(const StepMoment& from, double time) const noexcept {
    PlatePart part{.from = from, .to = moment_, .duration_s = time};
    for (std::size_t n = 0; n < response_.modes.size(); ++n) {
        const auto row = static_cast<Eigen::Index>(n);
        const double v0 = begin_.velocity[row];
        const double v1 = now_.velocity[row];
        const double slope0 = time * begin_.acceleration[row];
        const double slope1 = time * now_.acceleration[row];
        part.velocities[0][n] = v0;
        part.velocities[1][n] = slope0;
        part.velocities[2][n] = 3 * (v1 - v0) - 2 * slope0 - slope1;
        part.velocities[3][n] = 2 * (v0 - v1) + slope0 + slope1;
    }
    listener_->note(part);
}

double PlateSteps::energy() const noexcept {
    double twice = 0;
    for (std::size_t n = 0; n < response_.modes.size(); ++n) {
        const auto row = static_cast<Eigen::Index>(n);
        const double q = mode_displacements_.row(row).dot(begin_.y.matrix());
        const double v = mode_velocities_.row(row).dot(begin_.y.matrix());
        twice += response_.modes[n].stiffness_n_per_m * q * q + response_.modes[n].mass_kg * v * v;
    }
    return twice / 2;
}

}  // namespace hertzline
