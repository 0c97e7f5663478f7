#include "measures/run_record.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <span>

#include "measures/spectrum.hpp"

#include "core/scene/text.hpp"

namespace hertzline::measures {

namespace {

constexpr double block_numbers = 1 << 18;  // in a block: 2 MiB
constexpr double longest_block = 4096;     // samples; enough to make the calls cost nothing

}  // namespace

double rows_of_run(const Scene& scene) noexcept {
    const double product = scene.output.duration_s * scene.output.sample_rate_hz;
    const double whole = std::round(product);
    // two decimal fractions rounded to binary, then their product: off by less than four last bits
    const double rounding = 4 * std::numeric_limits<double>::epsilon() * product;
    return 1 + (std::abs(product - whole) <= rounding ? whole : std::floor(product));
}

TapSet taps_of_run(const Scene& scene, TapSet wanted) noexcept {
    const TapSet of_summary = TapSet(Tap::v_last) | Tap::v_out | Tap::v_plate;
    return wanted | (of_summary & taps_of(scene.end));
}

std::size_t block_of_run(const Scene& scene, TapSet taps) noexcept {
    const double numbers = channels_of(taps, static_cast<double>(scene.chain.spheres));
    return static_cast<std::size_t>(std::clamp(block_numbers / numbers, 1.0, longest_block));
}

RunRecord empty_record(TapSet measured, const EndModel& end, std::size_t rows) {
    RunRecord record;
    record.taps.push_back({Tap::v_out, {}});
    for (const Tap tap : measured - Tap::v_out) {
        record.taps.push_back({tap, {}});
    }
    for (TapRecord& tap : record.taps) {
        tap.values.reserve(rows);
    }
    record.v_out_smooth.reserve(end.has_plate ? rows : 0);
    return record;
}

void keep(const Samples& block, const EndModel& end, RunRecord& record) {
    record.peak_v_last = std::max(record.peak_v_last, peak_of(block[Tap::v_last]));
    for (TapRecord& tap : record.taps) {
        const std::span<const double> values = block[tap.tap];
        tap.values.insert(tap.values.end(), values.begin(), values.end());
    }
    if (end.has_plate) {
        std::ranges::transform(
            block[Tap::v_last], block[Tap::v_plate], std::back_inserter(record.v_out_smooth),
            [&end](double v_last, double v_plate) { return end.output_velocity(v_last, v_plate, true); });
    }
}

namespace {

/// The simulations of a run, one after the other.
class Sequence {
public:
    Sequence(Simulation& first, SceneSteps* steps, RunAccount& account)
        : now_(&first), steps_(steps), account_(account) {
        announce();
    }

    Simulation& now() noexcept { return *now_; }

    /// The present one is over.
    void close() { account_.add(*now_, went_on_); }

    /// Samples that the present one has still to give.
    std::size_t left() const noexcept {
        return next() == nullptr ? std::numeric_limits<std::size_t>::max()
                                 : static_cast<std::size_t>(next()->sample - now_->next_sample());
    }

    /// Goes over to the next one when it is due.
    Status advance() {
        if (left() > 0) {
            return Status::running;
        }
        const SceneStep& step = *next();
        auto simulation = std::make_unique<Simulation>(step.scene, steps_->options);
        if (step.goes_on) {
            const Status status = simulation->continue_from(*now_, step.sample);
            if (status != Status::running) {
                return status;
            }
        } else {
            simulation->begin_at(step.sample);
        }
        if (steps_->begins) {
            steps_->begins(done_);
        }
        close();
        went_on_ = step.goes_on;
        ++done_;
        steps_->last = std::move(simulation);
        now_ = steps_->last.get();
        announce();
        return Status::running;
    }

private:
    const SceneStep* next() const noexcept {
        return steps_ != nullptr && done_ < steps_->steps.size() ? &steps_->steps[done_] : nullptr;
    }
    void announce() noexcept {
        if (next() != nullptr && next()->goes_on) {
            now_->end_at(next()->sample);
        }
    }

    Simulation* now_;
    bool went_on_ = false;  // the present one from the one before
    SceneSteps* steps_;
    RunAccount& account_;
    std::size_t done_ = 0;
};

}  // namespace

Status simulate(Simulation& simulation, RunRecord& record, const std::function<bool(const Samples&)>& take,
                SceneSteps* steps) {
    using Clock = std::chrono::steady_clock;
    const Scene& scene = simulation.scene();
    const auto rows = static_cast<std::size_t>(rows_of_run(scene));
    Samples block = simulation.make_samples(block_of_run(scene, simulation.taps()));
    Sequence sequence(simulation, steps, record.account);
    while (record.rows() < rows) {
        const Clock::time_point before = Clock::now();
        Status status = sequence.advance();
        if (status == Status::running) {
            status = sequence.now().advance(
                block, std::min({block.capacity(), rows - record.rows(), sequence.left()}));
        }
        record.busy += Clock::now() - before;
        if (status != Status::running) {
            record.stopped = status == Status::stopped;
            return status;
        }
        keep(block, sequence.now().chain().end, record);
        if (!take(block)) {
            record.stopped = true;
            return Status::stopped;
        }
    }
    sequence.close();
    return Status::running;
}

std::vector<std::string> names_of(TapSet taps) {
    std::vector<std::string> names;
    for (const Tap tap : taps) {
        names.emplace_back(row_of(tap).name);
    }
    return names;
}

tl::expected<Tap, std::string> find_tap(std::string_view name, TapSet allowed) {
    if (const auto tap = tap_named(name); tap && allowed.contains(*tap)) {
        return *tap;
    }
    const std::vector<std::string> names = names_of(allowed);
    return tl::unexpected("found " + quoted_briefly(name) + ", allowed: " + comma_separated(names) +
                          suggestion(name, names));
}

TapSet measurable_among(std::span<const std::string> names) noexcept {
    TapSet taps;
    for (const std::string& name : names) {
        if (const auto tap = tap_named(name)) {
            taps |= TapSet(*tap) & measurable_taps;
        }
    }
    return taps;
}

}  // namespace hertzline::measures
