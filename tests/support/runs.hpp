#pragma once
// Short forms to run scenes in tests.

#include <stdexcept>
#include <vector>

#include "core/step_choice/pilot.hpp"
#include "hertzline/resolve.hpp"
#include "hertzline/simulation.hpp"

namespace hertzline::test {

inline constexpr TapSet everything = all_taps;

/// Resolves a scene. @throws std::runtime_error when it is refused
inline Scene settled(const Scene& scene) {
    Resolution result = resolve(scene);
    if (!result.faults.empty()) {
        throw std::runtime_error(result.faults.front().key + " " + result.faults.front().allowed);
    }
    return result.scene;
}

/// All samples of a run, taken `block` at a time.
struct Record {
    std::vector<double> v_last, v_plate, v_out, chain_x, chain_v;
    bool operator==(const Record&) const = default;
};

inline void append(Record& record, const Samples& block) {
    const auto take = [&block](std::vector<double>& to, Tap tap) {
        to.insert(to.end(), block[tap].begin(), block[tap].end());
    };
    take(record.v_last, Tap::v_last);
    take(record.v_plate, Tap::v_plate);
    take(record.v_out, Tap::v_out);
    take(record.chain_x, Tap::x_chain);
    take(record.chain_v, Tap::v_chain);
}

inline Record recorded(Simulation& simulation, std::size_t samples, std::size_t block) {
    Samples part = simulation.make_samples(block);
    Record record;
    for (std::size_t done = 0; done < samples; done += part.count) {
        if (simulation.advance(part, std::min(block, samples - done)) != Status::running) {
            throw std::runtime_error(simulation.failure());
        }
        append(record, part);
    }
    return record;
}

inline Record recorded(const Scene& scene, std::size_t samples, std::size_t block = 256) {
    Simulation simulation(scene, {.taps = everything});
    return recorded(simulation, samples, block);
}

}  // namespace hertzline::test
