#include "core/solvers/sampler.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace hertzline {

namespace {

/// Whole steps per sample, or 0 when samples do not fall on steps.
int steps_on_grid(double steps_per_sample) noexcept {
    const double whole = std::round(steps_per_sample);
    const bool on_grid = whole >= 1 && whole < 1e6 && std::abs(steps_per_sample - whole) <= 1e-9 * whole;
    return on_grid ? static_cast<int>(whole) : 0;
}

std::size_t trace_rows(double row_bytes, bool between) noexcept {
    // room for some steps at once; a row per step suffices on the grid, contact events need more off it
    const double least = between ? 2 * kernels::max_rows_per_step : 4;
    constexpr double affordable_bytes = 64.0 * 1024 * 1024;
    return static_cast<std::size_t>(
        std::clamp(affordable_bytes / row_bytes, least, 4.0 * kernels::max_rows_per_step));
}

/// Cubic through values and slopes at both ends of an interval: weights of the four.
struct Hermite {
    Hermite(double length, double z) noexcept
        : y0((1 - z) * (1 - z) * (1 + 2 * z)),
          d0((1 - z) * (1 - z) * z * length),
          y1(z * z * (3 - 2 * z)),
          d1(z * z * (z - 1) * length) {}
    double y0, d0, y1, d1;

    double value(double from, double slope, double to, double slope_there) const noexcept {
        return y0 * from + d0 * slope + y1 * to + d1 * slope_there;
    }
};

/// One row of a trace: displacements, velocities and accelerations of the probed bodies.
struct Row {
    Row(const double* row, std::size_t bodies) noexcept : x(row), v(row + bodies), a(row + 2 * bodies) {}
    const double* x;
    const double* v;
    const double* a;
};

/// A moment between two rows.
struct Between {
    Row from;
    Row to;
    Hermite weights;
    double displacement(std::size_t body) const noexcept {
        return weights.value(from.x[body], from.v[body], to.x[body], to.v[body]);
    }
    double velocity(std::size_t body) const noexcept {
        return weights.value(from.v[body], from.a[body], to.v[body], to.a[body]);
    }
};

/// A moment that is a row.
struct Exactly {
    Row row;
    double displacement(std::size_t body) const noexcept { return row.x[body]; }
    double velocity(std::size_t body) const noexcept { return row.v[body]; }
};

/// Where samples go: plain pointers, so that writing one does not make the compiler look up the others again.
struct Sink {
    explicit Sink(Samples& samples) noexcept
        : spheres(samples.spheres),
          last(samples.holds.outputs ? samples.v_last.data() : nullptr),
          plate(samples.v_plate.data()),
          out(samples.v_out.data()),
          chain_v(samples.holds.chain_velocities ? samples.chain_v.data() : nullptr),
          chain_x(samples.holds.chain_displacements ? samples.chain_x.data() : nullptr) {}
    std::size_t spheres;
    double* last;
    double* plate;
    double* out;
    double* chain_v;
    double* chain_x;
};

struct Ending {
    bool plate;
    double transmission;
    double overlap;
    std::size_t body;  ///< the end's place in a row
};

template <class Moment>
void put(const Sink& sink, std::size_t i, const Ending& end, const Moment& moment) noexcept {
    if (sink.last != nullptr) {
        const double v_last = moment.velocity(end.body - 1);
        double v_out = v_last;
        if (end.plate) {
            const double v_plate = moment.velocity(end.body);
            const double overlap =
                end.overlap + (moment.displacement(end.body - 1) - moment.displacement(end.body));
            v_out = (overlap > 0 ? end.transmission * v_last : 0) + v_plate;
            sink.plate[i] = v_plate;
        }
        sink.last[i] = v_last;
        sink.out[i] = v_out;
    }
    if (sink.chain_v != nullptr) {
        double* const v = sink.chain_v + i * sink.spheres;
        for (std::size_t s = 0; s < sink.spheres; ++s) {
            v[s] = moment.velocity(s);
        }
    }
    if (sink.chain_x != nullptr) {
        double* const x = sink.chain_x + i * sink.spheres;
        for (std::size_t s = 0; s < sink.spheres; ++s) {
            x[s] = moment.displacement(s);
        }
    }
}

}  // namespace

StepPosition StepPosition::of(double steps) noexcept {
    const auto whole = static_cast<std::int64_t>(steps);  // not negative: the same as floor, but quicker
    return {whole, static_cast<std::uint64_t>((steps - static_cast<double>(whole)) * 0x1p64)};
}

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
    : Samples(static_cast<std::size_t>(chain.spheres()), chain.end == EndKind::plate, capacity_, most) {}

Samples::Samples(std::size_t spheres_, bool plate, std::size_t capacity_, Wish most)
    : capacity(capacity_), spheres(spheres_) {
    if (most.outputs) {
        v_last.resize(capacity);
        v_out.resize(capacity);
        v_plate.resize(plate ? capacity : 0);
    }
    chain_v.resize(most.chain_velocities ? capacity * spheres : 0);
    chain_x.resize(most.chain_displacements ? capacity * spheres : 0);
}

double exact_step(double step_s, double sample_rate_hz) noexcept {
    const int grid = steps_on_grid(1 / (sample_rate_hz * step_s));
    return grid > 0 ? 1 / (sample_rate_hz * grid) : step_s;
}

Sampler::Sampler(const Chain& chain, double sample_rate_hz, double step_s, Wish most)
    : grid_(steps_on_grid(1 / (sample_rate_hz * step_s))),
      sample_period_(grid_ > 0 ? StepPosition{grid_, 0} : StepPosition::of(1 / (sample_rate_hz * step_s))),
      step_s_(step_s),
      plate_(chain.end == EndKind::plate),
      transmission_(chain.transmission),
      end_overlap_(chain.static_overlap[chain.spheres()]) {
    trace_.bodies = chain.bodies();
    trace_.first_body = most.chain() ? 0 : chain.spheres() - 1;
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

void Sampler::reset(const Chain& chain) noexcept {
    next_sample_ = 0;
    next_position_ = {};
    std::fill_n(trace_.rows, trace_.row_size(), 0.0);
    const Eigen::Index end = chain.spheres();
    trace_.rows[trace_.row_size() - 1] = chain.bias[end] * chain.inv_mass[end];
    trace_.steps[0] = 0;
    trace_.fractions[0] = 0;
    trace_.count = 1;
}

std::int64_t Sampler::step_needed(std::int64_t end) const noexcept {
    StepPosition last = next_position_;
    last.advance(sample_period_.times(end - 1 - next_sample_));
    return last.step + (last.part > 0 ? 1 : 0);
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
    if (grid_ > 0) {
        emit_rows(samples, end);
    } else {
        emit_between(samples, end);
    }
}

/// On the grid each row is a sample.
void Sampler::emit_rows(Samples* samples, std::int64_t end) noexcept {
    const std::size_t bodies = trace_.row_size() / 3;
    const Ending ending{plate_, transmission_, end_overlap_, bodies - 1};
    std::size_t row = 0;
    for (; row < trace_.count && next_sample_ < end; ++row, ++next_sample_) {
        if (samples != nullptr) {
            const Row at(trace_.rows + row * trace_.row_size(), bodies);
            put(Sink(*samples), samples->count++, ending, Exactly{at});
        }
        next_position_.advance(sample_period_);
    }
    drop_rows_before(row);
}

/// Off the grid a sample lies between two rows, which enclose a smooth piece of the motion.
void Sampler::emit_between(Samples* samples, std::int64_t end) noexcept {
    const std::size_t bodies = trace_.row_size() / 3;
    const Ending ending{plate_, transmission_, end_overlap_, bodies - 1};
    StepPosition at = next_position_;
    std::size_t row = 0;
    for (; row + 1 < trace_.count && next_sample_ < end; ++row) {
        const std::int64_t base = trace_.steps[row];
        const double begin = trace_.fractions[row];
        const double close = static_cast<double>(trace_.steps[row + 1] - base) + trace_.fractions[row + 1];
        const Row from(trace_.rows + row * trace_.row_size(), bodies);
        const Row to(trace_.rows + (row + 1) * trace_.row_size(), bodies);
        const double per_span = close > begin ? 1 / (close - begin) : 0;
        const auto moment = [&] { return static_cast<double>(at.step - base) + at.fraction(); };
        for (double when = moment(); when < close && next_sample_ < end; when = moment()) {
            if (samples != nullptr) {
                const Hermite weights((close - begin) * step_s_, (when - begin) * per_span);
                put(Sink(*samples), samples->count++, ending, Between{from, to, weights});
            }
            ++next_sample_;
            at.advance(sample_period_);
        }
        if (next_sample_ == end) {
            break;  // the following sample may lie in the same piece
        }
    }
    // the last sample asked for may coincide with the last row
    const bool on_last = next_sample_ < end && row + 1 == trace_.count && trace_.steps[row] == at.step &&
                         trace_.fractions[row] == at.fraction();
    if (on_last) {
        if (samples != nullptr) {
            const Row last(trace_.rows + row * trace_.row_size(), bodies);
            put(Sink(*samples), samples->count++, ending, Exactly{last});
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

double Sampler::bytes(double bodies, Wish most) noexcept {
    const double row = 24 * (most.chain() ? bodies : 2);
    return row * static_cast<double>(trace_rows(row, true));
}

}  // namespace hertzline
