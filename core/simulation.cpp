#include "core/simulation.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <stdexcept>

#include "core/stability.hpp"

namespace hertzline {

namespace {

/// Whole steps per sample, or 0 when samples do not fall on steps.
int steps_on_grid(double steps_per_sample) {
    const double whole = std::round(steps_per_sample);
    const bool on_grid = whole >= 1 && whole < 1e6 && std::abs(steps_per_sample - whole) <= 1e-9 * whole;
    return on_grid ? static_cast<int>(whole) : 0;
}

/// The step that is used: one that divides the sample period but for rounding is taken to divide it.
double exact_step(const Scene& scene) {
    if (!scene.numerics.integrator || !scene.numerics.step_s) {
        throw std::invalid_argument("Simulation: the scene's integrator and step are not resolved");
    }
    const double rate = scene.output.sample_rate_hz;
    const int grid = steps_on_grid(1 / (rate * *scene.numerics.step_s));
    return grid > 0 ? 1 / (rate * grid) : *scene.numerics.step_s;
}

std::size_t trace_rows(std::size_t row_size, bool between) {
    // room for some steps at once; a row per step suffices on the grid, events need more off it
    const std::size_t least = between ? 2 * max_rows_per_step : 4;
    const std::size_t affordable = (std::size_t{1} << 23) / std::max<std::size_t>(row_size, 1);
    return std::clamp<std::size_t>(affordable, least, 4 * max_rows_per_step);
}

/// Steps per sample as fixed point.
StepPosition fixed_point(double steps) {
    const double whole = std::floor(steps);
    return {static_cast<std::int64_t>(whole), static_cast<std::uint64_t>(std::ldexp(steps - whole, 64))};
}

/// Cubic through values and slopes at both ends of an interval: weights of the four.
struct Hermite {
    Hermite(double length, double z) noexcept
        : y0((1 - z) * (1 - z) * (1 + 2 * z)),
          d0((1 - z) * (1 - z) * z * length),
          y1(z * z * (3 - 2 * z)),
          d1(z * z * (z - 1) * length) {}
    double y0, d0, y1, d1;

    /// From what a trace row holds of a body: [x v a].
    double displacement(const double* from, const double* to) const noexcept {
        return y0 * from[0] + d0 * from[1] + y1 * to[0] + d1 * to[1];
    }
    double velocity(const double* from, const double* to) const noexcept {
        return y0 * from[1] + d0 * from[2] + y1 * to[1] + d1 * to[2];
    }
};

}  // namespace

StepPosition StepPosition::times(std::int64_t n) const noexcept {
    // schoolbook multiplication of the 64-bit fraction, in halves
    const auto count = static_cast<std::uint64_t>(n);
    const std::uint64_t mask = 0xffffffffU;
    const std::uint64_t low = (part & mask) * (count & mask);
    const std::uint64_t middle = (part >> 32U) * (count & mask) + (low >> 32U);
    const std::uint64_t other = (part & mask) * (count >> 32U) + (middle & mask);
    const std::uint64_t carry = (part >> 32U) * (count >> 32U) + (middle >> 32U) + (other >> 32U);
    return {step * n + static_cast<std::int64_t>(carry), part * count};
}

Samples::Samples(const Chain& chain, std::size_t capacity_, Wish most)
    : capacity(capacity_), spheres(static_cast<std::size_t>(chain.spheres())) {
    if (most.outputs) {
        v_last.resize(capacity);
        v_out.resize(capacity);
        v_plate.resize(chain.end == EndKind::plate ? capacity : 0);
    }
    chain_v.resize(most.chain_velocities ? capacity * spheres : 0);
    chain_x.resize(most.chain_displacements ? capacity * spheres : 0);
}

Simulation::Simulation(const Scene& scene, Wish most)
    : chain_(scene),
      integrator_(scene.numerics.integrator.value_or(Integrator::leapfrog)),
      step_s_(exact_step(scene)),
      grid_(steps_on_grid(1 / (scene.output.sample_rate_hz * step_s_))),
      sample_period_(grid_ > 0 ? StepPosition{grid_, 0} : fixed_point(1 / (scene.output.sample_rate_hz * step_s_))),
      most_(most),
      burst_(scene.drive, step_s_),
      state_(chain_),
      folded_(chain_, kernel_lanes()),
      horn_(ToneBurst::batch_steps) {
    trace_.bodies = chain_.bodies();
    trace_.first_body = most.chain() ? 0 : chain_.spheres() - 1;
    trace_.between = grid_ == 0;
    trace_.capacity = trace_rows(trace_.row_size(), trace_.between);
    rows_.resize(trace_.capacity * trace_.row_size());
    fractions_.resize(trace_.capacity);
    row_steps_.resize(trace_.capacity);
    trace_.rows = rows_.data();
    trace_.fractions = fractions_.data();
    trace_.steps = row_steps_.data();
    folded_.step_s = step_s_;
    reset();
}

void Simulation::reset() noexcept {
    state_.rest(chain_);
    folded_.contact_events = 0;
    ledger_ = {};
    ledger_.at_start = kinetic_energy(chain_, state_) + stored_energy(chain_, state_, 0);
    status_ = Status::running;
    next_sample_ = 0;
    next_position_ = {};
    horn_first_ = -1;
    front_ = (chain_.bias != 0).any() ? chain_.bodies() : 0;
    folded_.fold(chain_, state_, std::min<Eigen::Index>(1, chain_.bodies()));
    trace_.count = 0;
    begin_batch();
}

const ChainState& Simulation::state() noexcept {
    folded_.unfold(state_);
    return state_;
}

/// At every multiple of batch_steps: books, wavefront and drive. Depends on the step count alone, never on block sizes.
void Simulation::begin_batch() noexcept {
    collect_ledger();
    fold_active();
    burst_.fill(state_.step, horn_.data(), ToneBurst::batch_steps);
    horn_first_ = state_.step;
}

void Simulation::fold_active() noexcept {
    const Eigen::Index bodies = chain_.bodies();
    const bool all_folded = folded_.active() == bodies && state_.step > 0;
    if (all_folded) {
        return;
    }
    folded_.unfold(state_);
    front_ = std::max(front_, folded_.active());
    while (front_ > 0 && front_ < bodies && state_.x[front_ - 1] == 0 && state_.v[front_ - 1] == 0) {
        --front_;
    }
    // In one step a disturbance travels a bounded number of bodies: two with leapfrog (two looks at the dashpots), twelve
    // with Chin 4A (eight powers of the drift, two forces, one gradient, a switch may repeat the step: doubled).
    const Eigen::Index reach = integrator_ == Integrator::leapfrog ? 2 : 24;
    const Eigen::Index active = std::min(bodies, front_ + reach * ToneBurst::batch_steps + 1);
    folded_.fold(chain_, state_, active);
    kernel_ = kernel(integrator_, folded_.rows());
}

void Simulation::collect_ledger() noexcept {
    double* lost = folded_.column(Column::lost);
    double* work = folded_.column(Column::work);
    for (std::size_t s = 0; s < folded_.slots(); ++s) {
        ledger_.lost += lost[s];
        lost[s] = 0;
    }
    for (std::size_t lane = 0; lane < folded_.lanes(); ++lane) {
        ledger_.work += work[lane];
        work[lane] = 0;
    }
}

Ledger Simulation::ledger() noexcept {
    // a look must not change how later sums round, so the columns are only read
    Ledger now = ledger_;
    for (std::size_t s = 0; s < folded_.slots(); ++s) {
        now.lost += folded_.column(Column::lost)[s];
    }
    for (std::size_t lane = 0; lane < folded_.lanes(); ++lane) {
        now.work += folded_.column(Column::work)[lane];
    }
    return now;
}

double Simulation::energy_residual() noexcept {
    const Ledger books = ledger();
    const double scale = std::max(std::abs(books.work), books.lost);
    if (scale == 0) {
        return 0;
    }
    const double horn_x = burst_.at(state_.step, 0, -1e-6).x;
    const double held = kinetic_energy(chain_, state()) + stored_energy(chain_, state_, horn_x);
    return std::abs(held - books.at_start - books.work + books.lost) / scale;
}

bool Simulation::stable() noexcept {
    // peaks only ever grow, so a block that ends within the limit never left it
    for (Eigen::Index b = 0; b < folded_.active(); ++b) {
        state_.peak_overlap[b] = folded_.column(Column::peak_overlap)[folded_.slot(b)];
    }
    return step_s_ <= largest_stable_step(chain_, state_.peak_overlap, integrator_);
}

std::string Simulation::failure() const {
    if (status_ == Status::running) {
        return {};
    }
    Eigen::Index contact = 0;
    (chain_.stiffness.square() * state_.peak_overlap).maxCoeff(&contact);
    char text[256];
    std::snprintf(text, sizeof text,
                  "the step of %.4g s lies beyond the stability limit of %.4g s that the contacts reached by t = %.6g s "
                  "(stiffest: contact %lld, overlap %.3g m)",
                  step_s_, largest_stable_step(chain_, state_.peak_overlap, integrator_),
                  static_cast<double>(state_.step) * step_s_, static_cast<long long>(contact),
                  state_.peak_overlap[contact]);
    return text;
}

/// Takes steps until `step` is reached or the trace is full.
void Simulation::run_until(std::int64_t step) noexcept {
    while (state_.step < step && status_ == Status::running) {
        const std::int64_t in_batch = state_.step - horn_first_;
        const std::int64_t left_in_batch = ToneBurst::batch_steps - in_batch;
        const int count = static_cast<int>(std::min(left_in_batch, step - state_.step));
        const int taken = kernel_(folded_, burst_, horn_.data() + in_batch, state_.step, count, trace_);
        state_.step += taken;
        if (!stable()) {
            status_ = Status::unstable;
            return;
        }
        if (state_.step == horn_first_ + ToneBurst::batch_steps) {
            begin_batch();
        }
        if (taken < count) {
            return;
        }
    }
}

void Simulation::emit(Samples& samples, std::size_t i, const double* from, const double* to, double span,
                      double z) const noexcept {
    const Hermite between(span, z);
    const auto velocity = [&](std::size_t body) {
        return z == 0 ? from[3 * body + 1] : between.velocity(from + 3 * body, to + 3 * body);
    };
    const auto displacement = [&](std::size_t body) {
        return z == 0 ? from[3 * body] : between.displacement(from + 3 * body, to + 3 * body);
    };
    const std::size_t end = trace_.row_size() / 3 - 1;
    if (samples.holds.outputs) {
        const double v_last = velocity(end - 1);
        samples.v_last[i] = v_last;
        samples.v_out[i] = v_last;
        if (chain_.end == EndKind::plate) {
            const double v_plate = velocity(end);
            const double overlap =
                chain_.static_overlap[chain_.spheres()] + (displacement(end - 1) - displacement(end));
            samples.v_plate[i] = v_plate;
            samples.v_out[i] = (overlap > 0 ? chain_.transmission * v_last : 0) + v_plate;
        }
    }
    for (std::size_t s = 0; s < samples.spheres && samples.holds.chain_velocities; ++s) {
        samples.chain_v[i * samples.spheres + s] = velocity(s);
    }
    for (std::size_t s = 0; s < samples.spheres && samples.holds.chain_displacements; ++s) {
        samples.chain_x[i * samples.spheres + s] = displacement(s);
    }
}

/// Emits the samples before `end` that the trace's rows enclose; without a sink they are only counted.
void Simulation::emit_ready(Samples* samples, std::int64_t end) noexcept {
    std::size_t row = 0;
    while (next_sample_ < end) {
        const std::int64_t base = next_position_.step;
        const double when = next_position_.fraction();
        const auto moment = [&](std::size_t r) { return static_cast<double>(row_steps_[r] - base) + fractions_[r]; };
        while (row + 1 < trace_.count && moment(row + 1) <= when) {
            ++row;
        }
        const double begin = row < trace_.count ? moment(row) : 0;
        const bool on_row = row < trace_.count && begin == when;
        if (!on_row && row + 1 >= trace_.count) {
            break;
        }
        if (samples != nullptr) {
            const double* from = trace_.rows + row * trace_.row_size();
            if (on_row) {
                emit(*samples, samples->count, from, from, 0, 0);
            } else {
                const double span = moment(row + 1) - begin;
                emit(*samples, samples->count, from, from + trace_.row_size(), span * step_s_, (when - begin) / span);
            }
            ++samples->count;
        }
        ++next_sample_;
        next_position_.advance(sample_period_);
    }
    drop_old_rows(row);
}

void Simulation::drop_old_rows(std::size_t keep_from) noexcept {
    // on the grid a row is used up with its sample; off it, the last one begins the next interval
    keep_from = grid_ > 0 ? trace_.count : std::min(keep_from, trace_.count);
    const std::size_t kept = trace_.count - keep_from;
    std::memmove(trace_.rows, trace_.rows + keep_from * trace_.row_size(), kept * trace_.row_size() * sizeof(double));
    std::copy_n(fractions_.begin() + static_cast<std::ptrdiff_t>(keep_from), kept, fractions_.begin());
    std::copy_n(row_steps_.begin() + static_cast<std::ptrdiff_t>(keep_from), kept, row_steps_.begin());
    trace_.count = kept;
}

/// Sample 0 is the static equilibrium itself.
void Simulation::start_rows() noexcept {
    std::fill_n(trace_.rows, trace_.row_size(), 0.0);
    const Eigen::Index end = chain_.spheres();
    trace_.rows[trace_.row_size() - 1] = chain_.bias[end] * chain_.inv_mass[end];
    trace_.steps[0] = 0;
    trace_.fractions[0] = 0;
    trace_.count = 1;
}

Status Simulation::advance(Samples& samples, std::size_t count, Wish wish) noexcept {
    samples.first = next_sample_;
    samples.count = 0;
    samples.holds = wish;
    const auto block = static_cast<std::int64_t>(std::min(count, samples.capacity));
    if (!wish.outputs && !wish.chain()) {
        const Status status = skip(block);
        samples.count = static_cast<std::size_t>(next_sample_ - samples.first);
        return status;
    }
    if (produce(&samples, block) != Status::running) {
        samples.count = 0;
    }
    return status_;
}

Status Simulation::skip(std::int64_t count) noexcept {
    return produce(nullptr, count);
}

Status Simulation::produce(Samples* samples, std::int64_t count) noexcept {
    if (count <= 0 || status_ != Status::running) {
        return status_;
    }
    if (next_sample_ == 0) {
        start_rows();
    }
    const std::int64_t end = next_sample_ + count;
    StepPosition last = next_position_;
    last.advance(sample_period_.times(count - 1));
    const std::int64_t last_step = last.step + (last.part > 0 ? 1 : 0);
    if (samples == nullptr && grid_ > 0) {
        trace_.count = 0;
        trace_.next = Trace::never;
        run_until(last_step);
        if (status_ == Status::running) {
            next_sample_ = end;
            next_position_.advance(sample_period_.times(count));
        }
        return status_;
    }
    trace_.every = std::max(grid_, 1);
    trace_.next = (state_.step / trace_.every + 1) * trace_.every;
    for (;;) {
        emit_ready(samples, end);
        if (next_sample_ == end || status_ != Status::running) {
            return status_;
        }
        run_until(last_step);
    }
}

double Simulation::memory_bytes(const Scene& scene, Wish most) noexcept {
    const auto bodies = static_cast<double>(scene.chain.spheres) + 1;
    const double row = 24 * (most.chain() ? bodies : 2);
    const double state_and_constants = bodies * 8 * 11;
    const double folded = (bodies + 64) * 8 * static_cast<double>(Column::count);
    return state_and_constants + folded + row * 4 * static_cast<double>(max_rows_per_step);
}

}  // namespace hertzline
