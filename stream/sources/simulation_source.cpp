#include "stream/sources/simulation_source.hpp"

namespace hertzline::stream {

namespace {

constexpr Wish everything{.outputs = true, .chain_velocities = true, .chain_displacements = false};

}  // namespace

StreamFormat SimulationSource::format_of(const Scene& scene) noexcept {
    return {.taps = taps_of(scene.end.kind),
            .spheres = static_cast<std::size_t>(scene.chain.spheres),
            .sample_rate_hz = scene.output.sample_rate_hz,
            .frame_samples = scene.output.frame_samples};
}

double SimulationSource::memory_bytes(const Scene& scene) noexcept {
    return Simulation::memory_bytes(scene, everything);
}

SimulationSource::SimulationSource(const Scene& scene, bool outputs_always)
    : format_(format_of(scene)), outputs_always_(outputs_always), simulation_(scene, everything) {}

Samples SimulationSource::make_block() const {
    return {simulation_.chain(), static_cast<std::size_t>(format_.frame_samples), everything};
}

bool SimulationSource::read(Samples& samples, std::size_t count, TapSet wanted) noexcept {
    const Wish wish{.outputs = outputs_always_ || !(wanted - TapSet(Tap::v_chain)).empty(),
                    .chain_velocities = wanted.contains(Tap::v_chain),
                    .chain_displacements = false};
    return simulation_.advance(samples, count, wish) == Status::running;
}

bool SimulationSource::skip(std::int64_t count) noexcept {
    return simulation_.skip(count) == Status::running;
}

SourceAccount SimulationSource::account() const noexcept {
    return {.steps = simulation_.steps(), .contact_events = simulation_.contact_events()};
}

}  // namespace hertzline::stream
