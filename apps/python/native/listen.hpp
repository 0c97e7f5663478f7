#pragma once
// One tap of a running stream.

#include <pybind11/pybind11.h>

namespace hertzline::python {

void add_listen(pybind11::module_& module);

}  // namespace hertzline::python
