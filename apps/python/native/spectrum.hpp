#pragma once
// Spectra of any samples, as the program measures them.

#include <pybind11/pybind11.h>

namespace hertzline::python {

void add_spectrum(pybind11::module_& module);

}  // namespace hertzline::python
