#pragma once
// A scene as Python holds it: validated, and resolved on its first use.

#include <memory>
#include <string>
#include <vector>

#include "hertzline/resolve.hpp"
#include "hertzline/scene_file.hpp"

namespace hertzline::python {

/// A scene that never changes; it keeps its resolution.
class SceneObject {
public:
    explicit SceneObject(ParsedScene parsed) : parsed_(std::move(parsed)) {}

    const Scene& scene() const noexcept { return parsed_.scene; }
    const std::string& origin() const noexcept { return parsed_.origin; }

    /// Settles integrator and step, which takes as long as a few milliseconds of simulation. Needs the GIL, and releases it
    /// meanwhile. @throws py::value_error with every fault; py::error_already_set: MemoryError, KeyboardInterrupt
    std::shared_ptr<const Resolution> resolved();

    /// The same, to simulate it. @throws py::value_error for a live drive, too, whose samples only a stream has
    std::shared_ptr<const Resolution> resolved_to_run();

private:
    ParsedScene parsed_;
    std::shared_ptr<const Resolution> resolved_;  // nullptr: not yet
};

}  // namespace hertzline::python
