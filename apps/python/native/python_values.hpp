#pragma once
// Between C++ and Python: arrays that are not copied, JSON as objects, faults as Python's own exceptions. All of it needs the GIL.

#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include "core/scene/json.hpp"
#include "hertzline/scene.hpp"
#include "hertzline/taps.hpp"

namespace hertzline::python {

namespace py = pybind11;

/// Returns a text as Python has it; bytes of names of files that are not UTF-8 as \xNN.
py::str text_of(std::string_view text);

/// Returns a dict, list, str, int, float, bool or None.
py::object python_object(const Json& json);

/// Returns the faults, a line each. Faults of settings name the key alone.
std::string fault_text(std::vector<Fault> faults);

/// Lets exceptions whose texts name such files be raised.
void register_texts();

/// Does work on files. @throws py::error_already_set: OSError with the text of its std::runtime_error
void with_os_errors(const std::function<void()>& work);

/// Warns of each of them where Python called the function of the package. @throws py::error_already_set when a filter makes it an error
void warn_all(const std::vector<std::string>& warnings);

/// The object's state for pickle. Before protocol 2 pickle would make an object without its C++ part, which ends the program.
py::object reduced(const py::object& object, int protocol);

/// Checks that so many bytes are available. @throws py::error_already_set: MemoryError otherwise
void require_memory(const std::string& what, double bytes);

/// Returns a read-only array of memory that `owner` holds. @param strides in numbers; empty: row-major
py::array_t<double> view_of(const double* data, std::vector<py::ssize_t> shape, const py::handle& owner,
                            const std::vector<py::ssize_t>& strides = {});

/// Returns an array that takes over the vector's numbers. Nothing is copied.
template <class Number>
py::array_t<Number> array_of(std::vector<Number>&& values, std::vector<py::ssize_t> shape) {
    auto held = std::make_unique<std::vector<Number>>(std::move(values));
    const py::capsule owner(held.get(), [](void* data) { delete static_cast<std::vector<Number>*>(data); });
    const Number* const data = held.release()->data();
    return py::array_t<Number>(std::move(shape), data, owner);
}

template <class Number>
py::array_t<Number> array_of(std::vector<Number>&& values) {
    const auto size = static_cast<py::ssize_t>(values.size());
    return array_of(std::move(values), {size});
}

}  // namespace hertzline::python
