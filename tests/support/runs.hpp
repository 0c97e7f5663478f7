#pragma once
// Running scenes in tests, in few words.

#include <stdexcept>
#include <vector>

#include "core/simulation.hpp"
#include "core/step_choice/resolve.hpp"

namespace hertzline::test {

inline constexpr Wish everything{.outputs = true, .chain_velocities = true, .chain_displacements = true};

/// The scene with its step settled. Throws if it cannot be.
inline Scene settled(const Scene& scene) {
    ResolvedScene result = resolve(scene);
    if (!result.faults.empty()) {
        throw std::runtime_error(result.faults.front().key + " " + result.faults.front().allowed);
    }
    return result.scene;
}

inline Scene with_step(Scene scene, Integrator integrator, double step_s) {
    scene.numerics.integrator = integrator;
    scene.numerics.step_s = step_s;
    return scene;
}

/// All samples of a run, taken `block` at a time.
struct Record {
    std::vector<double> v_last, v_plate, v_out, chain_x, chain_v;
    bool operator==(const Record&) const = default;
};

inline void append(Record& record, const Samples& block) {
    const auto take = [&](std::vector<double>& to, const std::vector<double>& from, std::size_t width) {
        to.insert(to.end(), from.begin(), from.begin() + static_cast<std::ptrdiff_t>(width * block.count));
    };
    take(record.v_last, block.v_last, 1);
    take(record.v_plate, block.v_plate, block.v_plate.empty() ? 0 : 1);
    take(record.v_out, block.v_out, 1);
    take(record.chain_x, block.chain_x, block.spheres);
    take(record.chain_v, block.chain_v, block.spheres);
}

inline Record recorded(Simulation& simulation, std::size_t samples, std::size_t block) {
    Samples part(simulation.chain(), block, everything);
    Record record;
    for (std::size_t done = 0; done < samples; done += part.count) {
        if (simulation.advance(part, std::min(block, samples - done), everything) != Status::running) {
            throw std::runtime_error(simulation.failure());
        }
        append(record, part);
    }
    return record;
}

inline Record recorded(const Scene& scene, std::size_t samples, std::size_t block = 256) {
    Simulation simulation(scene, everything);
    return recorded(simulation, samples, block);
}

}  // namespace hertzline::test
