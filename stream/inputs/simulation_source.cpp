#include "stream/inputs/simulation_source.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace hertzline::stream {

StreamFormat SimulationSource::format_of(const Scene& scene) noexcept {
    return {.taps = streamed_taps_of(scene.end),
            .spheres = static_cast<std::size_t>(scene.chain.spheres),
            .sample_rate_hz = scene.output.sample_rate_hz,
            .frame_samples = scene.output.frame_samples,
            .repetition_hz = scene.drive.repetition_hz};
}

double SimulationSource::memory_bytes(const Scene& scene) noexcept {
    return Simulation::memory_bytes(scene, streamed_taps_of(scene.end));
}

SimulationSource::SimulationSource(const Scene& scene, TapSet always)
    : format_(format_of(scene)),
      always_(always & format_.taps),
      current_(std::make_unique<NextSimulation>(scene, options(), false)),
      epoch_{.repetition_hz = format_.repetition_hz} {}

bool SimulationSource::read(Samples& samples, std::size_t count, TapSet wanted) noexcept {
    return current_->simulation.advance(samples, count, wanted | always_) == Status::running;
}

bool SimulationSource::skip(std::int64_t count) noexcept {
    return current_->simulation.skip(count) == Status::running;
}

SourceAccount SimulationSource::account() const noexcept {
    return {.steps = before_.steps + now().steps(),
            .contact_events = before_.contact_events + now().contact_events()};
}

std::int64_t SimulationSource::change_at(const Epoch& epoch, double sample_rate_hz,
                                         std::int64_t from) noexcept {
    const Bursts bursts(sample_rate_hz, epoch.repetition_hz);
    const std::int64_t since = from - epoch.first_sample;
    if (!bursts.repeat()) {
        return from;
    }
    std::int64_t burst = bursts.at(since).burst;
    while (bursts.last_sample_until(burst) < since) {
        ++burst;
    }
    return epoch.first_sample + bursts.last_sample_until(burst);
}

void SimulationSource::take_up() noexcept {
    next_.reset(hand_over_.accept());
    if (next_) {
        // not at sample 0, so that every run has a beginning that its first scene describes
        const auto first = std::max<std::int64_t>({1, next_sample(), now().first_open_sample()});
        change_at_ = change_at(epoch_, format_.sample_rate_hz, first);
        if (next_->goes_on) {
            current_->simulation.end_at(change_at_);
        }
        hand_over_.applies(change_at_);
    }
}

void SimulationSource::change() noexcept {
    if (next_->goes_on) {
        if (next_->simulation.continue_from(current_->simulation, change_at_) != Status::running) {
            return;  // the present one gives the reason when it is read
        }
    } else {
        next_->simulation.begin_at(change_at_);
    }
    before_ = account();
    epoch_ = epoch_.next(format_.sample_rate_hz, change_at_, next_->simulation.scene().drive.repetition_hz);
    hand_over_.give_back(current_.release());
    current_ = std::move(next_);
}

std::int64_t SimulationSource::samples_to_change() noexcept {
    if (!next_) {
        take_up();
    }
    if (next_ &&
        next_sample() == change_at_) {  // at once, where the motion has not gone beyond the next sample
        change();
    }
    return next_ ? std::max<std::int64_t>(1, change_at_ - next_sample())
                 : std::numeric_limits<std::int64_t>::max();
}

}  // namespace hertzline::stream
