// The module hertzline._native. Users see the package hertzline, which is made of it.

#include "apps/python/native/module.hpp"

#include <pybind11/pybind11.h>

#include "measures/provenance.hpp"

PYBIND11_MODULE(_native, module) {
    module.doc() = "The native part of the package hertzline: use the package.";
    module.attr("version") = hertzline::measures::program_version();
    hertzline::python::add_scene(module);
    hertzline::python::add_run(module);
    hertzline::python::add_simulation(module);
    hertzline::python::add_spectrum(module);
    hertzline::python::add_load(module);
    hertzline::python::add_studies(module);
    hertzline::python::add_live(module);
}
