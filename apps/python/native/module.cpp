// The module hertzline._native: what Python's package hertzline is made of. The package beside it is what users see.

#include "measures/provenance.hpp"
#include <pybind11/pybind11.h>

#include "apps/python/native/control.hpp"
#include "apps/python/native/listen.hpp"
#include "apps/python/native/load.hpp"
#include "apps/python/native/run.hpp"
#include "apps/python/native/scene_object.hpp"
#include "apps/python/native/simulation.hpp"
#include "apps/python/native/spectrum.hpp"
#include "apps/python/native/studies.hpp"

PYBIND11_MODULE(_native, module) {
    module.doc() = "What the package hertzline is made of: use the package.";
    module.attr("version") = hertzline::measures::program_version();
    hertzline::python::add_scene(module);
    hertzline::python::add_run(module);
    hertzline::python::add_simulation(module);
    hertzline::python::add_spectrum(module);
    hertzline::python::add_load(module);
    hertzline::python::add_studies(module);
    hertzline::python::add_listen(module);
    hertzline::python::add_control(module);
}
