#pragma once
// A run of a scene, with all its samples in memory.

#include <pybind11/pybind11.h>

namespace hertzline::python {

void add_run(pybind11::module_& module);

}  // namespace hertzline::python
