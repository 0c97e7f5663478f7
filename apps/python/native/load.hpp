#pragma once
// Recordings, whole in memory.

#include <pybind11/pybind11.h>

namespace hertzline::python {

void add_load(pybind11::module_& module);

}  // namespace hertzline::python
