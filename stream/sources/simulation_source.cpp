#include "stream/sources/simulation_source.hpp"

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
      simulation_(scene, SimulationOptions{.taps = format_.taps, .stop = &stop_}) {}

bool SimulationSource::read(Samples& samples, std::size_t count, TapSet wanted) noexcept {
    return simulation_.advance(samples, count, wanted | always_) == Status::running;
}

bool SimulationSource::skip(std::int64_t count) noexcept {
    return simulation_.skip(count) == Status::running;
}

SourceAccount SimulationSource::account() const noexcept {
    return {.steps = simulation_.steps(), .contact_events = simulation_.contact_events()};
}

}  // namespace hertzline::stream
