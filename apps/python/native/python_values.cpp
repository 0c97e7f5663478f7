#include "apps/python/native/python_values.hpp"

#include <algorithm>

#include "core/scene/json.hpp"
#include "measures/resources.hpp"

namespace hertzline::python {

py::str text_of(std::string_view text) {
    return py::reinterpret_steal<py::str>(
        PyUnicode_DecodeUTF8(text.data(), static_cast<py::ssize_t>(text.size()), "backslashreplace"));
}

namespace {

void raise(PyObject* type, const char* text) {
    PyErr_SetObject(type, text_of(text).ptr());
}

}  // namespace

void register_texts() {
    py::register_local_exception_translator([](std::exception_ptr thrown) {
        try {
            std::rethrow_exception(std::move(thrown));
        } catch (const py::value_error& error) {
            raise(PyExc_ValueError, error.what());
        } catch (const py::key_error& error) {
            raise(PyExc_KeyError, error.what());
        }
    });
}

py::object python_object(const Json& json) {
    switch (json.type()) {
        case Json::value_t::object: {
            py::dict dict;
            for (const auto& [key, value] : json.items()) {
                dict[text_of(key)] = python_object(value);
            }
            return dict;
        }
        case Json::value_t::array: {
            py::list list;
            for (const auto& value : json) {
                list.append(python_object(value));
            }
            return list;
        }
        case Json::value_t::string:
            return text_of(json.get_ref<const std::string&>());
        case Json::value_t::boolean:
            return py::bool_(json.get<bool>());
        case Json::value_t::number_integer:
            return py::int_(json.get<std::int64_t>());
        case Json::value_t::number_unsigned:
            return py::int_(json.get<std::uint64_t>());
        case Json::value_t::number_float:
            return py::float_(json.get<double>());
        default:
            return py::none();
    }
}

std::string fault_text(std::vector<Fault> faults) {
    for (Fault& fault : faults) {
        if (fault.place.origin.starts_with("--")) {
            fault.place = {};  // an option of the program; here it is the key that the caller gave
        }
    }
    return hertzline::fault_text(faults);
}

void with_os_errors(const std::function<void()>& work) {
    try {
        work();
    } catch (const py::builtin_exception&) {
        throw;
    } catch (const std::runtime_error& error) {
        raise(PyExc_OSError, error.what());
        throw py::error_already_set();
    }
}

void warn_all(const std::vector<std::string>& warnings) {
    for (const std::string& warning : warnings) {
        if (PyErr_WarnEx(PyExc_UserWarning, text_of(warning).cast<std::string>().c_str(), 2) != 0) {
            throw py::error_already_set();
        }
    }
}

py::object reduced(const py::object& object, int protocol) {
    constexpr int with_objects_made_by_new = 2;
    const py::object plain = py::module_::import("builtins").attr("object");
    return plain.attr("__reduce_ex__")(object, std::max(protocol, with_objects_made_by_new));
}

void require_memory(const std::string& what, double bytes) {
    if (const auto shortage = measures::memory_shortage(what, bytes)) {
        PyErr_SetString(PyExc_MemoryError, shortage->c_str());
        throw py::error_already_set();
    }
}

py::array_t<double> view_of(const double* data, std::vector<py::ssize_t> shape, const py::handle& owner,
                            const std::vector<py::ssize_t>& strides) {
    std::vector<py::ssize_t> bytes;
    bytes.reserve(strides.size());
    for (const py::ssize_t stride : strides) {
        bytes.push_back(stride * static_cast<py::ssize_t>(sizeof(double)));
    }
    py::array_t<double> array = strides.empty() ? py::array_t<double>(std::move(shape), data, owner)
                                                : py::array_t<double>(std::move(shape), bytes, data, owner);
    array.attr("setflags")(py::arg("write") = false);
    return array;
}

}  // namespace hertzline::python
