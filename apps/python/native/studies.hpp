#pragma once
// Sweeps and searches whose rows stay in memory.

#include <pybind11/pybind11.h>

namespace hertzline::python {

void add_studies(pybind11::module_& module);

}  // namespace hertzline::python
