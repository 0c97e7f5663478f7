#pragma once
// A scene as Python holds it: validated, and resolved when that is first needed.

#include <memory>
#include <string>
#include <vector>

#include <pybind11/pybind11.h>

#include "core/scene/scene_toml.hpp"
#include "core/step_choice/resolve.hpp"

namespace hertzline::python {

/// Never changes, but for what it remembers.
class SceneObject {
public:
    explicit SceneObject(ParsedScene parsed) : parsed_(std::move(parsed)) {}

    const Scene& scene() const noexcept { return parsed_.scene; }
    const std::string& origin() const noexcept { return parsed_.origin; }

    /// With integrator and step settled, which takes as long as a few milliseconds of simulation. Needs the GIL, and gives it away
    /// meanwhile. @throws py::value_error with every fault; py::error_already_set: MemoryError, KeyboardInterrupt
    std::shared_ptr<const Resolution> resolved();

private:
    ParsedScene parsed_;
    std::shared_ptr<const Resolution> resolved_;  // nullptr: not yet
};

void add_scene(pybind11::module_& module);

}  // namespace hertzline::python
