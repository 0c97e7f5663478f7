#pragma once
// Requests to a running stream that is controlled.

#include <pybind11/pybind11.h>

namespace hertzline::python {

void add_control(pybind11::module_& module);

}  // namespace hertzline::python
