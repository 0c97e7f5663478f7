#include "hertzline/simulation.hpp"

#include <algorithm>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <pybind11/stl.h>

#include "apps/python/native/interruptible.hpp"
#include "apps/python/native/module.hpp"
#include "apps/python/native/python_values.hpp"
#include "apps/python/native/scene_object.hpp"
#include "core/scene/faults.hpp"
#include "measures/run.hpp"
#include "measures/tap_names.hpp"

namespace hertzline::python {

namespace {

/// A simulation and the block that it fills. A second thread is refused while one of them uses it.
class Steps {
public:
    /// The right to use it. @throws std::runtime_error while another thread has it
    class Use {
    public:
        explicit Use(Steps& steps) : lock_(steps.mutex_, std::try_to_lock) {
            if (!lock_) {
                throw std::runtime_error("another thread uses this simulation, allowed: one at a time");
            }
        }

    private:
        std::unique_lock<std::mutex> lock_;
    };

    Steps(const Resolution& resolved, TapSet taps)
        : simulation_(resolved, {.taps = taps}),
          block_(simulation_.make_samples(measures::block_of_run(simulation_.scene(), taps))) {}

    /// Simulates and returns the next samples of each tap: name and array [sample], or [sample][channel].
    /// @throws std::runtime_error when the motion becomes unstable; py::error_already_set of a signal handler
    py::dict advance(std::int64_t samples) {
        std::vector<std::vector<double>> columns(tap_count);
        for (const Tap tap : simulation_.taps()) {
            columns[index_of(tap)].reserve(static_cast<std::size_t>(samples) * block_.channels(tap));
        }
        for (std::int64_t done = 0; done < samples; done += static_cast<std::int64_t>(block_.count)) {
            fill(static_cast<std::size_t>(
                std::min<std::int64_t>(samples - done, static_cast<std::int64_t>(block_.capacity()))));
            for (const Tap tap : simulation_.taps()) {
                std::vector<double>& column = columns[index_of(tap)];
                column.insert(column.end(), block_[tap].begin(), block_[tap].end());
            }
        }
        py::dict result;
        for (const Tap tap : simulation_.taps()) {
            std::vector<py::ssize_t> shape{static_cast<py::ssize_t>(samples)};
            if (has_channels(tap, block_.counts())) {
                shape.push_back(static_cast<py::ssize_t>(block_.channels(tap)));
            }
            result[py::str(std::string(row_of(tap).name))] =
                array_of(std::move(columns[index_of(tap)]), std::move(shape));
        }
        return result;
    }

    /// Returns the bytes of the arrays that advance() returns.
    double bytes_of(std::int64_t samples) const {
        return sizeof(double) * static_cast<double>(samples) *
               channels_of(simulation_.taps(), channel_counts(simulation_.scene()));
    }

    Simulation& simulation() noexcept { return simulation_; }

private:
    static std::size_t index_of(Tap tap) noexcept { return static_cast<std::size_t>(tap); }

    void fill(std::size_t count) {
        Status status = Status::running;
        {
            const WithoutPython without_python;
            status = simulation_.advance(block_, count);
        }
        if (status != Status::running) {
            throw std::runtime_error(simulation_.failure());
        }
        if (PyErr_CheckSignals() != 0) {
            throw py::error_already_set();
        }
    }

    std::mutex mutex_;
    Simulation simulation_;
    Samples block_;
};

std::unique_ptr<Steps> simulation_of(SceneObject& object,
                                     const std::optional<std::vector<std::string>>& names) {
    Faults faults;
    const TapSet there = taps_of(object.scene());
    const TapSet taps =
        names ? measures::taps_named("taps", *names, there, faults) : recorded_taps(object.scene());
    if (taps.empty()) {
        faults.add("taps: found none, allowed: at least one");
    }
    faults.refuse<py::value_error>();
    return std::make_unique<Steps>(*object.resolved_to_run(), taps);
}

/// A function of Steps that calls act(simulation) when no other thread uses it.
template <class Act>
auto used(Act act) {
    return [act](Steps& steps) {
        const Steps::Use use(steps);
        return act(steps.simulation());
    };
}

py::dict advance(Steps& steps, std::int64_t samples) {
    if (samples < 1) {
        throw py::value_error("samples: found " + std::to_string(samples) + ", allowed: at least 1");
    }
    const Steps::Use use(steps);
    require_memory(std::to_string(samples) + " samples", steps.bytes_of(samples));
    return steps.advance(samples);
}

}  // namespace

void add_simulation(py::module_& module) {
    py::class_<Steps>(module, "Simulation")
        .def("advance", &advance, py::arg("samples"))
        .def("reset", used([](Simulation& simulation) { simulation.reset(); }))
        .def_property_readonly("sample",
                               used([](Simulation& simulation) { return simulation.next_sample(); }))
        .def_property_readonly("sample_rate_hz", used([](Simulation& simulation) {
                                   return simulation.scene().output.sample_rate_hz;
                               }))
        .def_property_readonly("step_s", used([](Simulation& simulation) { return simulation.step_s(); }))
        .def_property_readonly("steps", used([](Simulation& simulation) { return simulation.steps(); }))
        .def_property_readonly("contact_events",
                               used([](Simulation& simulation) { return simulation.contact_events(); }))
        .def_property_readonly("energy_residual",
                               used([](Simulation& simulation) { return simulation.energy_residual(); }));
    module.def("simulation", &simulation_of, py::arg("scene"), py::arg("taps"));
}

}  // namespace hertzline::python
