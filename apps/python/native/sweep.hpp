#pragma once
// A sweep whose rows stay in memory.

#include <pybind11/pybind11.h>

namespace hertzline::python {

void add_sweep(pybind11::module_& module);

}  // namespace hertzline::python
