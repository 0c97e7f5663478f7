#pragma once
// How far the outputs of one simulation are from those of a better one, by sums over the samples: bounded memory, however long.

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/step_choice/pilot.hpp"
#include "hertzline/samples.hpp"
#include "hertzline/simulation.hpp"

namespace hertzline {

/// The outputs that a run is judged by.
inline constexpr TapSet judged_outputs = TapSet(Tap::v_last) | Tap::v_plate | Tap::v_out | Tap::v_centre |
                                         Tap::v_face | Tap::p_axis | Tap::p_points;

/// A simulation of the judged outputs, and its present block.
struct JudgedRun {
    /// @param capacity of the block @param stop, max_steps as of SimulationOptions. @throws std::bad_alloc
    JudgedRun(const ResolvedScene& scene, std::size_t capacity, const std::atomic<bool>* stop,
              std::int64_t max_steps = SimulationOptions{}.max_steps, std::size_t threads = 1,
              double water_part = 1)
        : simulation(scene, {.taps = judged_outputs,
                             .ledger = LedgerKeeping::off,
                             .stop = stop,
                             .threads = threads,
                             .water_part = water_part,
                             .max_steps = max_steps}),
          block(simulation.make_samples(capacity)) {}

    /// Takes the next samples into the block. @returns false when the simulation failed or was stopped
    bool advance(std::size_t count) noexcept { return simulation.advance(block, count) == Status::running; }
    /// Error of the fit of a modal plate's response, which all steps share [relative].
    double fit_error() const noexcept { return simulation.fit_error(); }

    Simulation simulation;
    Samples block;
};

/// Sums of squares of each output's differences, as velocities.
class OutputErrors {
public:
    /// @param better the better run
    explicit OutputErrors(const JudgedRun& better) {
        for (const Tap tap : better.block.taps()) {
            sums_[static_cast<std::size_t>(tap)].resize(better.block.channels(tap));
            scales_[static_cast<std::size_t>(tap)] = velocity_per_unit(tap, better.simulation.chain().end);
        }
    }

    /// The next samples of both, of the judged outputs that both have.
    void add(const Samples& run, const Samples& better) noexcept {
        for (const Tap tap : run.taps() & better.taps() & judged_outputs) {
            std::vector<Sums>& sums = sums_[static_cast<std::size_t>(tap)];
            const double scale = scales_[static_cast<std::size_t>(tap)];
            const std::span<const double> values = run[tap];
            const std::span<const double> truths = better[tap];
            for (std::size_t channel = 0; channel < sums.size(); ++channel) {
                Sums of_channel = sums[channel];
                for (std::size_t i = channel; i < better.count * sums.size(); i += sums.size()) {
                    const double truth = scale * truths[i];
                    const double wrong = scale * values[i] - truth;
                    of_channel.wrong += wrong * wrong;
                    of_channel.norm += truth * truth;
                }
                sums[channel] = of_channel;
            }
        }
    }

    /// Relative L2 of the worst output. One below quiet_column of the loudest is judged on that scale.
    double worst() const noexcept {
        double loudest = 0;
        for (const std::vector<Sums>& channels : sums_) {
            for (const Sums& sums : channels) {
                loudest = std::max(loudest, sums.norm);
            }
        }
        double found = 0;
        for (const std::vector<Sums>& channels : sums_) {
            for (const Sums& sums : channels) {
                const double scale = std::max(sums.norm, quiet_column * quiet_column * loudest);
                found = scale > 0 ? std::max(found, std::sqrt(sums.wrong / scale)) : found;
            }
        }
        return found;
    }

private:
    struct Sums {
        double wrong = 0;
        double norm = 0;
    };
    std::array<double, tap_count> scales_{};         ///< to velocities
    std::array<std::vector<Sums>, tap_count> sums_;  ///< [tap][channel]
};

}  // namespace hertzline
