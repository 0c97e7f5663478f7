// The module hertzline._native. Users see the package hertzline, which is made of it.

#include "apps/python/native/module.hpp"

#include <string>

#include <pybind11/pybind11.h>

#include "apps/python/native/python_values.hpp"
#include "measures/provenance.hpp"

namespace {

/// Refuses a NumPy whose arrays the module would misread: pybind11 knows the layout of NumPy 2 from 2.12 on.
/// @throws pybind11::import_error
void check_numpy() {
    if constexpr (PYBIND11_VERSION_HEX < 0x020C0000) {
        const auto version = pybind11::module_::import("numpy").attr("__version__").cast<std::string>();
        if (std::stoi(version) >= 2) {
            throw pybind11::import_error(
                "found NumPy " + version + ", allowed is one before 2: hertzline was built with pybind11 2." +
                std::to_string(PYBIND11_VERSION_MINOR) + ", which cannot read arrays of NumPy 2");
        }
    }
}

}  // namespace

PYBIND11_MODULE(_native, module) {
    check_numpy();
    hertzline::python::register_texts();
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
