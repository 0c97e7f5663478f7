#include "measures/run.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <span>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "core/model/chain.hpp"
#include "core/model/drive.hpp"
#include "core/model/energy.hpp"
#include "core/model/strength.hpp"
#include "core/model/validity.hpp"
#include "core/scene/elements.hpp"
#include "core/scene/faults.hpp"
#include "core/scene/text.hpp"
#include "measures/measuring.hpp"
#include "measures/record_warnings.hpp"
#include "measures/resources.hpp"
#include "measures/tap_names.hpp"

namespace hertzline::measures {

namespace {

constexpr double block_numbers = 1 << 18;  // in a block: 2 MiB
constexpr double longest_block = 4096;     // samples; enough to make the calls cost nothing
constexpr TapSet plate_centre = TapSet(Tap::v_plate) | Tap::v_centre;

void add_load(ContactLoad& largest, const ContactLoad& load) {
    largest.force_n = std::max(largest.force_n, load.force_n);
    largest.pressure_pa = std::max(largest.pressure_pa, load.pressure_pa);
    largest.overlap_ratio = std::max(largest.overlap_ratio, load.overlap_ratio);
    for (std::size_t kind = 0; kind < contact_kinds; ++kind) {
        largest.pressures_pa[kind] = std::max(largest.pressures_pa[kind], load.pressures_pa[kind]);
    }
}

PlateEnergy energy_of_plate(const Ledger& ledger) {
    return {ledger.passed, ledger.plate_lost, ledger.plate_held, ledger.radiated()};
}

PlateEnergy sum_of(const PlateEnergy& a, const PlateEnergy& b) {
    return {a.passed + b.passed, a.lost + b.lost, a.held + b.held, a.radiated + b.radiated};
}

/// The larger one; NaN where either is NaN.
double larger_or_nan(double a, double b) {
    return std::isnan(a) || a > b ? a : b;
}

/// Adds the account of a simulation that is over. @param continues the next one continues its motion and ledger, and accounts for
/// them
void add_account(Run& run, Simulation& simulation, bool continues) {
    const Chain& chain = simulation.chain();
    run.steps += simulation.steps();
    run.step_s = simulation.step_s();
    run.contact_events += simulation.contact_events();
    for (std::size_t element = 0; element < simulation.elements(); ++element) {
        add_contacts(run, element_scene(simulation.scene(), element), simulation.chain(element),
                     simulation.state(element).peak_overlap);
    }
    if (!continues) {
        run.energy_residual = larger_or_nan(run.energy_residual, simulation.energy_residual());
        const Ledger ledger = simulation.ledger();
        run.holder_lost += ledger.holder_lost;
        if (chain.horn_inv_mass > 0) {
            const HornEnergy before = run.horn.value_or(HornEnergy{});
            run.horn = HornEnergy{before.source + ledger.source_work, before.lost + ledger.horn_lost,
                                  before.held + ledger.horn_held};
        }
        if (chain.end.plate) {
            run.plate = sum_of(run.plate.value_or(PlateEnergy{}), energy_of_plate(ledger));
        }
    }
}

void keep_points(Run& run, const Samples& block) {
    const std::span<const double> values = block[Tap::p_points];
    const std::size_t points = block.channels(Tap::p_points);
    run.peaks_p_points.resize(points);
    for (std::size_t i = 0; i < values.size(); ++i) {
        double& peak = run.peaks_p_points[i % points];
        peak = std::max(peak, std::abs(values[i]));
        if (i % points == 0) {
            run.p_first.push_back(values[i]);
        }
    }
    run.peak_p_points = peak_of(run.peaks_p_points);
}

/// The channel that is measured: of an array the middle element's.
std::size_t measured_channel(const Samples& block, Tap tap, const Scene& scene) {
    return block.channels(tap) > 1 ? middle_element(scene) : 0;
}

/// Appends the tap's samples; of an array those of the middle element.
void append_samples(const Samples& block, Tap tap, const Scene& scene, std::vector<double>& values) {
    const std::span<const double> all = block[tap];
    const std::size_t channels = block.channels(tap);
    if (channels == 1) {
        values.insert(values.end(), all.begin(), all.end());
        return;
    }
    for (std::size_t i = measured_channel(block, tap, scene); i < all.size(); i += channels) {
        values.push_back(all[i]);
    }
}

/// Keeps the next samples.
void keep(Run& run, const Samples& block, const EndModel& end) {
    const std::span<const double> of_last = block[Tap::v_last];
    for (std::size_t i = measured_channel(block, Tap::v_last, run.resolved.scene); i < of_last.size();
         i += block.channels(Tap::v_last)) {
        run.peak_v_last = std::max(run.peak_v_last, std::abs(of_last[i]));
    }
    if (block.taps().contains(Tap::p_points)) {
        keep_points(run, block);
    }
    for (TapRecord& tap : run.taps) {
        append_samples(block, tap.tap, run.resolved.scene, tap.values);
    }
    if (end.has_plate) {
        const std::size_t before = run.v_out_smooth.size();
        run.v_out_smooth.resize(before + block.count);
        std::ranges::transform(
            block[Tap::v_last], block[Tap::v_plate],
            run.v_out_smooth.begin() + static_cast<std::ptrdiff_t>(before),
            [&end](double v_last, double v_plate) { return end.output_velocity(v_last, v_plate, true); });
    }
}

/// How far the plates of a simulation bend: at rest, and the integral of their centres' velocities from there on. Nothing is integrated
/// with fewer than twenty samples in a period of the drive or of a plate: aliases would add up.
class Deflection {
public:
    explicit Deflection(const Simulation& simulation) {
        for (std::size_t element = 0; element < simulation.elements(); ++element) {
            now_m_.push_back(sag_at_rest(simulation.chain(element)));
        }
        follow(simulation);
    }

    /// Goes on with another simulation, which continues the motion.
    void follow(const Simulation& simulation) {
        constexpr double fewest = 20;
        const Scene& scene = simulation.scene();
        double highest_hz = scene.drive.kind == DriveKind::none ? 0 : highest_frequency_hz(scene.drive);
        for (std::size_t element = 0; element < simulation.elements(); ++element) {
            highest_hz = std::max(highest_hz, plate_hz(simulation.chain(element)));
        }
        rate_hz_ = scene.output.sample_rate_hz;
        shows_it_ = shows_it_ && rate_hz_ >= fewest * highest_hz;
    }

    /// Returns the largest of any plate in these samples [m]; 0 without a plate.
    double largest_in(const Samples& block) {
        double largest = 0;
        const TapSet shown = shows_it_ ? (plate_centre & block.taps()) : TapSet();
        for (const Tap tap : shown) {
            const std::span<const double> velocities = block[tap];
            for (std::size_t i = 0; i < velocities.size(); ++i) {
                double& now = now_m_[i % now_m_.size()];
                now += velocities[i] / rate_hz_;
                largest = std::max(largest, std::abs(now));
            }
        }
        return largest;
    }

private:
    std::vector<double> now_m_;
    double rate_hz_ = 0;
    bool shows_it_ = true;  // so far, and from now on
};

SimulationOptions simulation_options(const RunOptions& options, TapSet taps) {
    SimulationOptions simulated{.taps = taps, .stop = options.stop};
    simulated.live = options.live;
    simulated.threads = options.threads;
    return simulated;
}

/// The simulations of a run, one after the other.
class Sequence {
public:
    Sequence(Run& run, Simulation& first, const RunOptions& options)
        : run_(run), now_(&first), options_(options), deflection_(first) {
        announce();
    }

    Simulation& now() noexcept { return *now_; }

    /// Notes how far the present one's plates bend in these samples.
    void note_deflection(const Samples& block) {
        run_.deflection_m = std::max(run_.deflection_m, deflection_.largest_in(block));
    }

    /// Ends the present one. @param continues its motion goes on in the next one
    void close(bool continues) { add_account(run_, *now_, continues); }

    /// Samples that the present one has still to give.
    std::size_t left() const noexcept {
        return next() == nullptr ? std::numeric_limits<std::size_t>::max()
                                 : static_cast<std::size_t>(next()->sample - now_->next_sample());
    }

    /// Changes to the next one when it is due.
    Status advance() {
        Status status = Status::running;
        while (left() == 0 && status == Status::running) {
            status = change();
        }
        return status;
    }

private:
    Status change() {
        const SceneStep& step = *next();
        auto simulation =
            std::make_unique<Simulation>(step.scene, simulation_options(options_, now_->taps()));
        if (step.continued) {
            const Status status = simulation->continue_from(*now_, step.sample);
            if (status != Status::running) {
                return status;
            }
            deflection_.follow(*simulation);
        } else {
            simulation->begin_at(step.sample);
            deflection_ = Deflection(*simulation);
        }
        if (options_.begins) {
            options_.begins(done_);
        }
        close(step.continued);
        ++done_;
        run_.last_scene = step.scene;
        run_.resolved.estimate = worse_of(run_.resolved.estimate, step.estimate);
        later_ = std::move(simulation);
        now_ = later_.get();
        announce();
        return Status::running;
    }

    const SceneStep* next() const noexcept {
        return done_ < options_.steps.size() ? &options_.steps[done_] : nullptr;
    }
    void announce() noexcept {
        if (next() != nullptr && next()->continued) {
            now_->end_at(next()->sample);
        }
    }

    Run& run_;
    Simulation* now_;
    const RunOptions& options_;
    Deflection deflection_;
    std::unique_ptr<Simulation> later_;  // the present one, unless it is the first
    std::size_t done_ = 0;
};

/// Fills the run from the sequence; the last simulation is its present one.
Status fill(Run& run, Sequence& sequence, const std::function<bool(const Samples&)>& take) {
    using Clock = std::chrono::steady_clock;
    const Scene& scene = run.resolved.scene;
    const auto rows = static_cast<std::size_t>(rows_of_run(scene));
    Samples block = sequence.now().make_samples(block_of_run(scene, sequence.now().taps()));
    while (run.rows() < rows) {
        const Clock::time_point before = Clock::now();
        Status status = sequence.advance();
        if (status == Status::running) {
            status = sequence.now().advance(block,
                                            std::min({block.capacity(), rows - run.rows(), sequence.left()}));
        }
        run.busy += Clock::now() - before;
        if (status != Status::running) {
            run.stopped = status == Status::stopped;
            if (run.stopped) {
                sequence.close(false);
            }
            return status;
        }
        keep(run, block, sequence.now().chain().end);
        sequence.note_deflection(block);
        if (take && !take(block)) {
            run.stopped = true;
            sequence.close(false);
            return Status::stopped;
        }
    }
    sequence.close(false);
    return Status::running;
}

/// Continues a run whose end rings, at most ten times as far, to the first duration of two digits at whose end it does not. Where a beat
/// is at its least an extrapolation would be wrong by factors.
std::optional<double> rung_down_s(const Run& run, Simulation& simulation) {
    constexpr std::size_t times = 10;
    constexpr std::size_t most_samples = 2'000'000;
    const Scene& scene = run.resolved.scene;
    const std::vector<double>& v_out = run.taps.front().values;
    const std::optional<double> ratio = ringing_ratio(scene, v_out);
    if (!ratio || *ratio <= ringing_share) {
        return std::nullopt;
    }
    const std::size_t period = period_samples(scene);
    std::vector<double> record(v_out.end() - static_cast<std::ptrdiff_t>(period), v_out.end());
    const std::size_t before = v_out.size() - record.size();
    double peak = peak_of(v_out);
    Samples block = simulation.make_samples(block_of_run(scene, simulation.taps()));
    for (Scene longer = scene;;) {
        longer.output.duration_s = next_duration(longer.output.duration_s);
        const double rows = rows_of_run(longer);
        if (rows > static_cast<double>(std::min(times * v_out.size(), v_out.size() + most_samples))) {
            return std::nullopt;
        }
        while (static_cast<double>(before + record.size()) < rows) {
            const auto left = static_cast<std::size_t>(rows) - before - record.size();
            if (simulation.advance(block, std::min(block.capacity(), left)) != Status::running) {
                return std::nullopt;
            }
            append_samples(block, Tap::v_out, scene, record);
        }
        peak = std::max(peak, peak_of(record));
        if (peak_of(std::span(record).last(period)) <= ringing_share * peak) {
            return longer.output.duration_s;
        }
    }
}

}  // namespace

TapSet measured_taps(const Scene& scene, TapSet asked) noexcept {
    return (asked | measured_unasked) & taps_of(scene);
}

double rows_of_run(const Scene& scene) noexcept {
    const double product = scene.output.duration_s * scene.output.sample_rate_hz;
    const double whole = std::round(product);
    // two decimal fractions rounded to binary, then their product: off by less than four last bits
    const double rounding = 4 * std::numeric_limits<double>::epsilon() * product;
    return 1 + (std::abs(product - whole) <= rounding ? whole : std::floor(product));
}

TapSet taps_of_run(const Scene& scene, TapSet wanted) noexcept {
    const TapSet of_summary = TapSet(Tap::v_last) | Tap::v_out | plate_centre | Tap::p_points;
    return wanted | (of_summary & taps_of(scene));
}

std::size_t block_of_run(const Scene& scene, TapSet taps) noexcept {
    const double numbers = channels_of(taps, channel_counts(scene));
    return static_cast<std::size_t>(std::clamp(block_numbers / numbers, 1.0, longest_block));
}

double memory_of_run(const Scene& scene, TapSet taps, TapSet measured) {
    const double rows = rows_of_run(scene);
    const double records =
        2 +
        static_cast<double>((measured | Tap::v_out).size());  // v_out also without its jumps; the first point
    const double block =
        static_cast<double>(block_of_run(scene, taps)) * channels_of(taps, channel_counts(scene));
    return Simulation::memory_bytes(scene, taps) + block * sizeof(double) + records * rows * sizeof(double) +
           SpectrumAnalyser::bytes_needed(rows);
}

std::optional<std::string> longest_run_fault(const Scene& scene) {
    const double rows = rows_of_run(scene);
    if (rows <= max_run_rows) {
        return std::nullopt;
    }
    return "output.duration_s: found " + number_text(rows) + " samples, allowed: at most " +
           number_text(max_run_rows) + ", the longest record of a spectrum";
}

std::optional<std::string> band_from_fault(std::optional<double> from_hz) {
    if (!from_hz || (*from_hz >= 0 && std::isfinite(*from_hz))) {
        return std::nullopt;
    }
    return "found " + number_text(*from_hz) + ", allowed: a finite number from 0 [Hz]";
}

Run simulate(const Resolution& resolved, const RunOptions& options) {
    const auto start = std::chrono::steady_clock::now();
    const Scene& scene = resolved.scene;
    const TapSet measured = measured_taps(scene, options.measured);
    Simulation simulation(resolved,
                          simulation_options(options, taps_of_run(scene, options.recorded | measured)));
    Run run = empty_run(resolved, measured, simulation.chain().end);
    run.setup_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    Sequence sequence(run, simulation, options);
    const Status status = fill(run, sequence, options.take);
    if (status != Status::running && status != Status::stopped) {
        throw std::runtime_error(sequence.now().failure());
    }
    if (status == Status::running && options.steps.empty()) {
        run.rung_down_s = rung_down_s(run, simulation);
    }
    return run;
}

void add_contacts(Run& run, const Scene& scene, const Chain& chain, const Eigen::ArrayXd& peaks) {
    add_load(run.load, contact_load(chain, peaks));
    run.static_pressure_pa =
        std::max(run.static_pressure_pa, contact_load(chain, chain.static_overlap).pressure_pa);
    const JudgedContacts judged = judge_contacts(scene, chain, peaks);
    const std::optional<double> ratio = strength_ratio(judged);
    if (ratio && !(run.strength_ratio && *ratio <= *run.strength_ratio)) {
        run.strength_ratio = ratio;
        run.strength_warning = strength_warning(judged);
    }
}

Run empty_run(Resolution resolved, TapSet measured, const EndModel& end) {
    const auto rows = static_cast<std::size_t>(rows_of_run(resolved.scene));
    Run run;
    run.resolved = std::move(resolved);
    run.taps.push_back({Tap::v_out, {}, {}});
    for (const Tap tap : measured - Tap::v_out) {
        run.taps.push_back({tap, {}, {}});
    }
    for (TapRecord& tap : run.taps) {
        tap.values.reserve(rows);
    }
    run.v_out_smooth.reserve(end.has_plate ? rows : 0);
    return run;
}

Status fill(Run& run, Simulation& simulation, const std::function<bool(const Samples&)>& take) {
    const RunOptions no_steps;
    Sequence sequence(run, simulation, no_steps);
    return fill(run, sequence, take);
}

bool motion_goes_on(const Scene& from, const Scene& to) {
    if (is_array(from) || is_array(to)) {  // whose motion is not handed over
        return false;
    }
    Scene same = from;
    same.drive = to.drive;
    same.drive.kind = from.drive.kind;
    same.drive.material = from.drive.material;
    same.numerics.step_s = to.numerics.step_s;
    same.numerics.accuracy = to.numerics.accuracy;
    return same == to;
}

namespace {

/// Adds the faults of a step after another one. @param sample of the step before @param before its scene
void check_step(const SceneStep& step, std::int64_t sample, Scene before, Faults& faults) {
    before.output.duration_s = step.scene.output.duration_s;  // that of the run's own scene counts
    if (const std::vector<Fault> wrong = validate(step.scene); !wrong.empty()) {
        faults.add("steps", wrong);
        return;
    }
    if (step.sample < sample + (step.continued || sample == 0 ? 1 : 0)) {
        faults.add("steps", fmt::format("found one from sample {} on, allowed: from 1 on and in their order",
                                        step.sample));
    }
    if (taps_of(step.scene) != taps_of(before) || channel_counts(step.scene) != channel_counts(before) ||
        step.scene.output.sample_rate_hz != before.output.sample_rate_hz) {
        faults.add("steps",
                   "found a scene with other taps, other numbers of spheres, points or elements, or another "
                   "sample rate, allowed: equal ones");
    } else if (step.continued &&
               !(Simulation::can_hand_over(before) && Simulation::can_hand_over(step.scene) &&
                 motion_goes_on(before, step.scene))) {
        faults.add("steps",
                   "found a motion that cannot be continued, allowed: those of can_hand_over(), by scenes "
                   "that differ in drive and step");
    }
}

}  // namespace

}  // namespace hertzline::measures

namespace hertzline {

Run run(const Resolution& resolved, const RunOptions& options) {
    const ResolvedScene checked = resolved;
    const Scene& scene = checked.scene();
    {
        Faults faults;
        faults.add({}, validate(scene));
        faults.refuse<std::invalid_argument>();
    }
    const TapSet there = taps_of(scene);
    const TapSet measured = measures::measured_taps(scene, options.measured);
    Faults faults;
    faults.add(measures::longest_run_fault(scene));
    faults.add("band_from_hz", measures::band_from_fault(options.band_from_hz));
    const auto refuse = [&faults](TapSet wrong, TapSet allowed) {
        for (const Tap tap : wrong) {
            faults.add("taps", "found " + std::string(row_of(tap).name) +
                                   ", allowed: " + comma_separated(measures::names_of(allowed)));
        }
    };
    refuse((options.measured | options.recorded) - there, there);
    refuse((options.measured & there) - measures::measurable_taps, there & measures::measurable_taps);
    for (std::size_t i = 0; i < options.steps.size(); ++i) {
        const SceneStep* before = i == 0 ? nullptr : &options.steps[i - 1];
        measures::check_step(options.steps[i], before != nullptr ? before->sample : 0,
                             before != nullptr ? before->scene : scene, faults);
    }
    faults.refuse<std::invalid_argument>();
    throw_if<OutOfMemory>(measures::memory_shortage(
        "this run",
        measures::memory_of_run(scene, measures::taps_of_run(scene, options.recorded | measured), measured)));
    Run run = measures::simulate(resolved, options);
    if (!run.stopped) {
        SpectrumAnalyser analyser(run.rows(), resolved.scene.output.sample_rate_hz);
        measures::measure(run, &analyser, options.band_from_hz, options.stop);
    }
    return run;
}

Run run(const Scene& scene, const RunOptions& options) {
    const auto start = std::chrono::steady_clock::now();
    const Resolution resolved = resolve(scene, scene.output.duration_s, options.stop, options.threads);
    const double setup_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    Run run = hertzline::run(resolved, options);
    run.setup_s += setup_s;
    return run;
}

}  // namespace hertzline
