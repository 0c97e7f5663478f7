#pragma once
// The parts of the module hertzline._native, a source each.

#include <pybind11/pybind11.h>

namespace hertzline::python {

void add_scene(pybind11::module_& module);
void add_run(pybind11::module_& module);         ///< a run of a scene, with all its samples in memory
void add_simulation(pybind11::module_& module);  ///< a scene in motion that Python advances
void add_spectrum(pybind11::module_& module);    ///< spectra of any samples, as the program measures them
void add_load(pybind11::module_& module);        ///< recordings
void add_studies(pybind11::module_& module);     ///< sweeps and searches whose rows stay in memory
void add_live(pybind11::module_& module);        ///< running streams

}  // namespace hertzline::python
