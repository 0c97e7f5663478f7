#include "stream/inputs/simulation_source.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include "core/model/drive.hpp"
#include "measures/resources.hpp"
#include "stream/inputs/live_drive.hpp"

namespace hertzline::stream {

std::optional<Fault> SimulationSource::fault_of(const Scene& scene) {
    constexpr std::size_t most_points = 64;
    const std::size_t points = scene.output.points_m.size();
    return points <= most_points ? std::nullopt
                                 : std::optional(Fault{"output.points_m", std::to_string(points) + " points",
                                                       std::to_string(most_points) + " in a stream at most"});
}

StreamFormat SimulationSource::format_of(const Scene& scene) noexcept {
    StreamFormat format{.taps = streamed_taps_of(scene),
                        .counts = channel_counts(scene),
                        .sample_rate_hz = scene.output.sample_rate_hz,
                        .frame_samples = scene.output.frame_samples,
                        .repetition_hz = scene.drive.repetition_hz};
    if (scene.drive.kind == DriveKind::live) {
        format.latency_samples = std::llround(scene.drive.start_s * scene.output.sample_rate_hz);
    }
    return format;
}

double SimulationSource::memory_bytes(const Scene& scene) {
    return Simulation::memory_bytes(scene, streamed_taps_of(scene));
}

SimulationSource::SimulationSource(const Scene& scene, TapSet always, LiveDrive* live)
    : live_(live),
      format_(format_of(scene)),
      always_(always & format_.taps),
      current_(std::make_unique<NextSimulation>(scene, options(), false)),
      hand_over_(*current_),
      epoch_{.repetition_hz = format_.repetition_hz} {
    if (const auto fault = fault_of(scene)) {
        throw std::invalid_argument(fault->message());
    }
}

SimulationOptions SimulationSource::options() const noexcept {
    SimulationOptions options{.taps = format_.taps};
    options.threads = static_cast<std::size_t>(measures::usable_processors());
    options.live = live_ != nullptr ? live_->motion() : nullptr;
    return options;
}

void SimulationSource::interrupt() noexcept {
    hand_over_.interrupt();
    if (live_ != nullptr) {
        live_->interrupt();
    }
}

void SimulationSource::end() noexcept {
    if (live_ != nullptr) {
        live_->stop();
    }
}

std::string SimulationSource::failure() const {
    std::string failure = now().failure();
    return failure.empty() && live_ != nullptr ? live_->failure() : failure;
}

std::optional<DriveCounts> SimulationSource::drive() const noexcept {
    return live_ != nullptr ? std::optional(live_->counts()) : std::nullopt;
}

std::vector<std::string> SimulationSource::take_warnings() {
    return live_ != nullptr ? live_->take_warnings() : std::vector<std::string>{};
}

bool SimulationSource::wait_for(std::int64_t count) noexcept {
    return live_ == nullptr || live_->wait_for(next_sample() + count);
}

/// Lets the present simulation work. As often as it is given up on the way, the next one begins where the block was to begin.
/// @param work takes the simulation and the most samples @returns false when there are no more samples
template <class Work>
bool SimulationSource::proceed(const Work& work) noexcept {
    constexpr std::int64_t all = std::numeric_limits<std::int64_t>::max();
    const std::int64_t first = next_sample();
    progress_.fetch_add(1, std::memory_order_relaxed);
    Status status = work(current_->simulation, all);
    while (status == Status::stopped && take_up_at_once(std::max<std::int64_t>(1, first))) {
        if (first == 0) {  // its sample at rest comes before, so that every run begins with its first scene
            current_->stop.store(false, std::memory_order_relaxed);
            current_->simulation.reset();
            status = work(current_->simulation, 1);
        } else {
            change();
            status = work(current_->simulation, all);
        }
    }
    progress_.fetch_add(1, std::memory_order_relaxed);
    if (live_ != nullptr) {
        live_->release(next_sample());
    }
    return status == Status::running;
}

bool SimulationSource::read(Samples& samples, std::size_t count, TapSet wanted) noexcept {
    return proceed([&](Simulation& simulation, std::int64_t most) {
        const auto block = std::min(count, static_cast<std::size_t>(most));
        return simulation.advance(samples, block, wanted | always_);
    });
}

bool SimulationSource::skip(std::int64_t count) noexcept {
    return proceed(
        [&](Simulation& simulation, std::int64_t most) { return simulation.skip(std::min(count, most)); });
}

SourceAccount SimulationSource::account() noexcept {
    return {.steps = before_.steps + now().steps(),
            .contact_events = before_.contact_events + now().contact_events(),
            .energy_residual = std::max(before_.energy_residual, current_->simulation.energy_residual())};
}

std::int64_t SimulationSource::change_at(const Epoch& epoch, double burst_end_s, double sample_rate_hz,
                                         std::int64_t from) noexcept {
    const Bursts bursts(sample_rate_hz, epoch.repetition_hz);
    const std::int64_t since = from - epoch.first_sample;
    if (!bursts.repeat()) {
        return from;
    }
    const BurstPlace place = bursts.at(since);
    std::int64_t burst = place.burst;
    while (bursts.last_sample_until(burst) < since) {
        ++burst;
    }
    const double second = sample_rate_hz;  // in samples
    if (const std::int64_t next = bursts.last_sample_until(burst);
        static_cast<double>(next - since) <= second) {
        return epoch.first_sample + next;
    }
    const double left = burst_end_s * sample_rate_hz + 1 - static_cast<double>(place.sample);
    return from + (left > 0 && left <= second ? static_cast<std::int64_t>(std::ceil(left)) : 0);
}

void SimulationSource::take_up() noexcept {
    next_.reset(hand_over_.accept());
    if (next_) {
        // not at sample 0, so that every run has a beginning that its first scene describes
        const auto first = std::max<std::int64_t>({1, next_sample(), now().first_open_sample()});
        change_at_ = change_at(epoch_, current_->burst_end_s, format_.sample_rate_hz, first);
        if (next_->goes_on) {
            current_->simulation.end_at(change_at_);
        }
        hand_over_.applies(change_at_);
    }
}

/// The present simulation was stopped: the next one shall follow at this sample without its motion. @returns false when all were stopped
bool SimulationSource::take_up_at_once(std::int64_t sample) noexcept {
    if (!next_) {
        next_.reset(hand_over_.accept());
    }
    if (!next_ || hand_over_.interrupted()) {
        return false;
    }
    next_->goes_on = false;
    gave_up_ = true;
    change_at_ = sample;
    hand_over_.applies(sample);
    return true;
}

void SimulationSource::change() noexcept {
    if (next_->goes_on) {
        if (next_->simulation.continue_from(current_->simulation, change_at_) != Status::running) {
            return;  // the present one gives the reason when it is read
        }
    } else {
        next_->simulation.begin_at(change_at_);
    }
    const double ended = before_.energy_residual;
    before_ = account();
    if (next_->goes_on || gave_up_) {  // the ledger is continued, or stands beyond the last sample
        before_.energy_residual = ended;
    }
    epoch_ = epoch_.next(format_.sample_rate_hz, change_at_, next_->simulation.scene().drive.repetition_hz);
    epoch_.gave_up = std::exchange(gave_up_, false);
    hand_over_.give_back(current_.release());
    current_ = std::move(next_);
}

std::int64_t SimulationSource::samples_to_change() noexcept {
    if (!next_) {
        take_up();
    }
    if (next_ &&
        next_sample() == change_at_) {  // at once, where the motion has not gone beyond the next sample
        progress_.fetch_add(1, std::memory_order_relaxed);
        change();
        progress_.fetch_add(1, std::memory_order_relaxed);
    }
    return next_ ? std::max<std::int64_t>(1, change_at_ - next_sample())
                 : std::numeric_limits<std::int64_t>::max();
}

}  // namespace hertzline::stream
