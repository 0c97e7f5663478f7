#include "core/solvers/sampling/sampler.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>

#include "core/solvers/sampling/trace_moments.hpp"

namespace hertzline {

namespace {

std::size_t trace_rows(double row_bytes, bool between) noexcept {
    // room for some steps at once; a row per step suffices on the grid, contact events need more off it
    const double least = between ? 2 * kernels::max_rows_per_step : 4;
    constexpr double affordable_bytes = 64.0 * 1024 * 1024;
    return static_cast<std::size_t>(
        std::clamp(affordable_bytes / row_bytes, least, 4.0 * kernels::max_rows_per_step));
}

/// Whether the taps show more of the chain than its far end.
bool of_all_bodies(TapSet taps) noexcept {
    return !(taps & near_taps).empty();
}

}  // namespace

/// Puts moments down as samples.
class Sampler::Writer {
public:
    /// @param bodies in a row of the trace; the last is the end
    Writer(Samples& samples, EndTaps& end_taps, ContactForces& contact_forces, const Chain& chain,
           std::size_t bodies) noexcept
        : end_taps_(end_taps, samples),
          contact_forces_(contact_forces),
          v_chain_(samples.holds.contains(Tap::v_chain) ? samples.room(Tap::v_chain).data() : nullptr),
          x_chain_(samples.holds.contains(Tap::x_chain) ? samples.room(Tap::x_chain).data() : nullptr),
          f_chain_(samples.holds.contains(Tap::f_chain) ? samples.room(Tap::f_chain).data() : nullptr),
          f_first_(samples.holds.contains(Tap::f_first) ? samples.room(Tap::f_first).data() : nullptr),
          spheres_(samples.spheres()),
          end_overlap_(chain.static_overlap[chain.spheres()]),
          end_(bodies - 1) {}

    template <class Moment>
    void put(const Moment& moment) noexcept {
        put_chain(moment);
        if (f_chain_ != nullptr) {
            put_contacts(moment, spheres_ + 1, f_chain_ + end_taps_.next() * (spheres_ + 1));
        }
        if (f_first_ != nullptr) {
            put_contacts(moment, 1, f_first_ + end_taps_.next());
        }
        if (end_taps_.shows_end()) {
            put_end(moment);
        }
        end_taps_.advance(1);
    }

private:
    template <class Moment>
    void put_chain(const Moment& moment) const noexcept {
        const std::size_t at = end_taps_.next() * spheres_;
        for (std::size_t s = 0; v_chain_ != nullptr && s < spheres_; ++s) {
            v_chain_[at + s] = moment.velocity(s);
        }
        for (std::size_t s = 0; x_chain_ != nullptr && s < spheres_; ++s) {
            x_chain_[at + s] = moment.displacement(s);
        }
    }

    /// @param contacts how many, from the horn on
    template <class Moment>
    void put_contacts(const Moment& moment, std::size_t contacts, double* out) const noexcept {
        contact_forces_.begin(end_taps_.samples().first + static_cast<std::int64_t>(end_taps_.next()), 1);
        for (std::size_t c = 0; c < contacts; ++c) {
            *contact_forces_.displacements() = moment.displacement(c);
            *contact_forces_.velocities() = moment.velocity(c);
            contact_forces_.put(out + c, contacts);
        }
    }

    template <class Moment>
    void put_end(const Moment& moment) const noexcept {
        const EndMotion& motion = end_taps_.motion();
        const std::size_t i = motion.count;
        const FarEnd far = moment.far_end(end_ - 1);
        motion.v_last[i] = far.velocities[0];
        motion.v_end[i] = far.velocities[1];
        motion.closed[i] = end_overlap_ + far.approach > 0;
        if (motion.x_last != nullptr) {
            motion.x_last[i] = moment.displacement(end_ - 1);
            motion.x_end[i] = moment.displacement(end_);
        }
    }

    EndTapsWriter end_taps_;
    ContactForces& contact_forces_;
    double* v_chain_;
    double* x_chain_;
    double* f_chain_;
    double* f_first_;
    std::size_t spheres_;
    double end_overlap_;
    std::size_t end_;
};

int steps_per_sample(double step_s, double sample_rate_hz) noexcept {
    const double steps = 1 / (sample_rate_hz * step_s);
    const double whole = std::round(steps);
    const bool on_grid = whole >= 1 && whole < 1e6 && std::abs(steps - whole) <= 1e-9 * whole;
    return on_grid ? static_cast<int>(whole) : 0;
}

double exact_step(double step_s, double sample_rate_hz) noexcept {
    const int grid = steps_per_sample(step_s, sample_rate_hz);
    return grid > 0 ? 1 / (sample_rate_hz * grid) : step_s;
}

Sampler::Sampler(const Chain& chain, const Scene& scene, double step_s, const SimulationOptions& options)
    : chain_(chain),
      grid_(steps_per_sample(step_s, scene.output.sample_rate_hz)),
      sample_period_(grid_ > 0 ? FixedTime{grid_, 0}
                               : FixedTime::of(1 / (scene.output.sample_rate_hz * step_s))),
      step_s_(step_s),
      end_taps_(chain, scene, options),
      contact_forces_(chain, end_taps_.horn()) {
    trace_.bodies = chain.bodies();
    trace_.first_body = of_all_bodies(options.taps) ? 0 : chain.spheres() - 1;
    trace_.between = grid_ == 0;
    trace_.every = std::max(grid_, 1);
    trace_.capacity = trace_rows(static_cast<double>(trace_.row_size()) * sizeof(double), trace_.between);
    rows_.resize(trace_.capacity * trace_.row_size());
    fractions_.resize(trace_.capacity);
    steps_.resize(trace_.capacity);
    trace_.rows = rows_.data();
    trace_.fractions = fractions_.data();
    trace_.steps = steps_.data();
}

void Sampler::reset() noexcept {
    next_sample_ = 0;
    next_position_ = {};
    std::fill_n(trace_.rows, trace_.row_size(), 0.0);
    const auto bodies = static_cast<Eigen::Index>(trace_.row_size() / 3);
    const auto velocity = [this](Eigen::Index body) {
        return body >= 0 && body < chain_.impact_spheres ? chain_.impact_velocity : 0;
    };
    const auto dashpot = [&](Eigen::Index contact) {
        const bool closed = contact < chain_.bodies() && chain_.static_overlap[contact] > 0;
        return closed ? chain_.damping[contact] * (velocity(contact - 1) - velocity(contact)) : 0;
    };
    for (Eigen::Index i = 0; i < bodies; ++i) {
        const Eigen::Index body = trace_.first_body + i;
        const double force = dashpot(body) - dashpot(body + 1) - chain_.drag[body] * velocity(body);
        trace_.rows[bodies + i] = velocity(body);
        trace_.rows[2 * bodies + i] = (force + chain_.bias[body]) * chain_.inv_mass[body];
    }
    trace_.steps[0] = 0;
    trace_.fractions[0] = 0;
    trace_.count = 1;
}

void Sampler::begin_with(const ChainState& state) noexcept {
    reset();
    const auto bodies = static_cast<Eigen::Index>(trace_.row_size() / 3);
    std::copy_n(state.x.data() + trace_.first_body, bodies, trace_.rows);
    std::copy_n(state.v.data() + trace_.first_body, bodies, trace_.rows + bodies);
}

std::int64_t Sampler::step_needed(std::int64_t end) const noexcept {
    FixedTime last = next_position_;
    last.advance(sample_period_.times(end - 1 - next_sample_));
    return last.rounded_up();
}

kernels::Trace& Sampler::wanted_from(std::int64_t step) noexcept {
    trace_.next = (step / trace_.every + 1) * trace_.every;
    return trace_;
}

bool Sampler::pass_over() noexcept {
    if (grid_ == 0) {
        return false;  // the next sample may lie between two steps of which one is already taken
    }
    trace_.count = 0;
    trace_.next = kernels::Trace::never;
    return true;
}

void Sampler::passed_over(std::int64_t end) noexcept {
    next_position_.advance(sample_period_.times(end - next_sample_));
    next_sample_ = end;
}

void Sampler::emit(Samples* samples, std::int64_t end) noexcept {
    std::optional<Writer> writer;
    if (samples != nullptr) {
        writer.emplace(*samples, end_taps_, contact_forces_, chain_, trace_.row_size() / 3);
    }
    if (grid_ > 0) {
        emit_rows(writer ? &*writer : nullptr, end);
    } else {
        emit_between(writer ? &*writer : nullptr, end);
    }
}

/// On the grid each row is a sample.
void Sampler::emit_rows(Writer* writer, std::int64_t end) noexcept {
    const std::size_t bodies = trace_.row_size() / 3;
    std::size_t row = 0;
    for (; row < trace_.count && next_sample_ < end; ++row, ++next_sample_) {
        if (writer != nullptr) {
            writer->put(AtRow{TraceRow(trace_.rows + row * trace_.row_size(), bodies)});
        }
        next_position_.advance(sample_period_);
    }
    drop_rows_before(row);
}

/// Off the grid a sample lies between two rows, which enclose a smooth piece of the motion.
void Sampler::emit_between(Writer* writer, std::int64_t end) noexcept {
    const std::size_t bodies = trace_.row_size() / 3;
    FixedTime at = next_position_;
    std::size_t row = 0;
    for (; row + 1 < trace_.count && next_sample_ < end; ++row) {
        const std::int64_t base = trace_.steps[row];
        const double begin = trace_.fractions[row];
        const double close = static_cast<double>(trace_.steps[row + 1] - base) + trace_.fractions[row + 1];
        const TraceRow from(trace_.rows + row * trace_.row_size(), bodies);
        const TraceRow to(trace_.rows + (row + 1) * trace_.row_size(), bodies);
        const auto moment = [&] { return static_cast<double>(at.whole - base) + at.fraction(); };
        double when = moment();
        if (when < close) {
            const double length = (close - begin) * step_s_;
            const double per_span = 1 / (close - begin);
            const FarEndPiece piece(from, to, bodies - 2, length);
            for (; when < close && next_sample_ < end; when = moment()) {
                if (writer != nullptr) {
                    writer->put(BetweenRows{from, to, piece, length, (when - begin) * per_span});
                }
                ++next_sample_;
                at.advance(sample_period_);
            }
        }
        if (next_sample_ == end) {
            break;  // the following sample may lie in the same piece
        }
    }
    // the last sample asked for may coincide with the last row
    const bool on_last = next_sample_ < end && row + 1 == trace_.count && trace_.steps[row] == at.whole &&
                         trace_.fractions[row] == at.fraction();
    if (on_last) {
        if (writer != nullptr) {
            writer->put(AtRow{TraceRow(trace_.rows + row * trace_.row_size(), bodies)});
        }
        ++next_sample_;
        at.advance(sample_period_);
    }
    next_position_ = at;
    drop_rows_before(row);
}

void Sampler::drop_rows_before(std::size_t row) noexcept {
    const std::size_t kept = trace_.count - row;
    std::memmove(trace_.rows, trace_.rows + row * trace_.row_size(),
                 kept * trace_.row_size() * sizeof(double));
    std::copy_n(trace_.fractions + row, kept, trace_.fractions);
    std::copy_n(trace_.steps + row, kept, trace_.steps);
    trace_.count = kept;
}

double Sampler::bytes(double bodies, TapSet taps) noexcept {
    const double row = 24 * (of_all_bodies(taps) ? bodies : 2);
    return row * static_cast<double>(trace_rows(row, true));
}

}  // namespace hertzline
