// hertzline's integrators behind the peers' interface, each over a ladder of steps.

#include <algorithm>
#include <cstdio>
#include <memory>
#include <stdexcept>

#include "bench/peers/problem.hpp"
#include "core/model/chain.hpp"
#include "core/model/energy.hpp"
#include "core/scene/scene_words.hpp"
#include "hertzline/resolve.hpp"
#include "hertzline/simulation.hpp"

namespace hertzline::bench {

namespace {

/// Settings worth measuring. An integrator that does not work with fixed steps gets its ladder here.
std::vector<Numerics> ladder(Integrator integrator) {
    std::vector<Numerics> settings;
    for (const double step_ns :
         {1600.0, 1200.0, 1150.0, 1100.0, 1050.0, 1000.0, 950.0, 900.0, 850.0, 800.0, 750.0, 700.0,
          650.0,  600.0,  550.0,  500.0,  450.0,  400.0,  300.0, 250.0, 200.0, 175.0, 150.0, 125.0}) {
        settings.push_back({.integrator = integrator, .step_s = step_ns * 1e-9, .accuracy = {}, .poles = {}});
    }
    for (const int steps_per_sample : {1, 2, 3, 4, 6, 8, 12, 16, 24, 32}) {
        const double step_s = 100e-9 / steps_per_sample;
        settings.push_back({.integrator = integrator, .step_s = step_s, .accuracy = {}, .poles = {}});
    }
    return settings;
}

std::string setting_text(const Numerics& numerics) {
    char text[32];
    if (numerics.step_s) {
        std::snprintf(text, sizeof text, "step %.4g ns", *numerics.step_s * 1e9);
    } else {
        std::snprintf(text, sizeof text, "accuracy %.0e", numerics.accuracy.value_or(default_accuracy));
    }
    return text;
}

class Run {
public:
    explicit Run(const Scene& scene)
        : simulation_(scene, {.ledger = LedgerKeeping::off}),  // the peers keep no ledger, either
          block_(simulation_.make_samples(block)) {}

    void operator()(Trace& trace) {
        simulation_.reset();
        for (std::size_t from = 0; from < trace.v_last.size(); from += block_.count) {
            if (simulation_.advance(block_, std::min(block, trace.v_last.size() - from)) != Status::running) {
                throw std::runtime_error(simulation_.failure());
            }
            std::ranges::copy(block_[Tap::v_last], trace.v_last.begin() + from);
            if (!trace.v_plate.empty()) {
                std::ranges::copy(block_[Tap::v_plate], trace.v_plate.begin() + from);
                std::ranges::copy(block_[Tap::v_out], trace.v_out.begin() + from);
            }
        }
    }

private:
    static constexpr std::size_t block = 1024;
    Simulation simulation_;
    Samples block_;
};

}  // namespace

Contender hertzline_contender(const Scene& scene) {
    return {Kind::ours, "hertzline " + std::string(word(*scene.numerics.integrator)),
            setting_text(scene.numerics),
            [run = std::make_shared<Run>(scene)](Trace& trace) { (*run)(trace); }};
}

std::vector<Contender> hertzline_contenders(const Scene& scene) {
    std::vector<Contender> list;
    for (const auto& integrator : Words<Integrator>::all) {
        for (const Numerics& numerics : ladder(integrator.choice)) {
            Scene asked = scene;
            asked.numerics = numerics;
            const Resolution settled = resolve(asked);
            if (settled.faults.empty()) {  // faults: the step is beyond the stability limit
                list.push_back(hertzline_contender(settled.scene));
                list.back().setting = setting_text(numerics);
            }
        }
    }
    return list;
}

}  // namespace hertzline::bench
