#pragma once
// A scene in motion, that Python takes step by step.

#include <pybind11/pybind11.h>

namespace hertzline::python {

void add_simulation(pybind11::module_& module);

}  // namespace hertzline::python
