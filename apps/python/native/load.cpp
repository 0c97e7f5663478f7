#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <pybind11/stl.h>

#include "apps/python/native/interruptible.hpp"
#include "apps/python/native/module.hpp"
#include "apps/python/native/python_values.hpp"
#include "core/scene/faults.hpp"
#include "core/scene/json.hpp"
#include "core/scene/text.hpp"
#include "hertzline/taps.hpp"
#include "recordings/recording.hpp"
#include "recordings/recording_formats.hpp"

namespace hertzline::python {

namespace {

constexpr std::size_t portion = 65'536;  // rows that are read at a time

/// Samples without a gap, and their beginning in the run and in the recording.
struct Stretch {
    std::int64_t first = 0;
    std::size_t row = 0;
};

struct Recording {
    recordings::RecordingHead head;
    std::vector<double> values;  ///< row-major, [row][column]
    std::vector<Stretch> stretches;
    std::vector<std::string> warnings;  ///< of the reader

    std::size_t rows() const { return values.size() / head.columns.size(); }
};

void read_rows(recordings::RecordingReader& reader, Recording& recording, const std::atomic<bool>& stop) {
    recordings::RecordedRows rows;
    std::int64_t due = -1;  // the sample that follows
    while (!stop && reader.read(rows, portion)) {
        if (rows.first != due) {
            recording.stretches.push_back({rows.first, recording.rows()});
        }
        recording.values.insert(recording.values.end(), rows.values.begin(), rows.values.end());
        due = rows.first + static_cast<std::int64_t>(rows.values.size() / recording.head.columns.size());
    }
}

std::shared_ptr<Recording> load(const std::string& path, std::optional<double> sample_rate_hz) {
    throw_if<py::value_error>(recordings::recording_fault(path, recordings::Access::reading));
    if (sample_rate_hz && !(*sample_rate_hz > 0 && std::isfinite(*sample_rate_hz))) {
        throw py::value_error("sample_rate_hz: found " + number_text(*sample_rate_hz) +
                              ", allowed: more than 0");
    }
    auto recording = std::make_shared<Recording>();
    recordings::ReadOptions options{.sample_rate_hz = sample_rate_hz, .warn = {}};
    options.warn = [&](const std::string& warning) { recording->warnings.push_back(warning); };
    with_os_errors([&] {
        interruptible_with_files({path}, [&](const std::atomic<bool>& stop) {
            options.stop = &stop;
            const auto reader = recordings::open_reader(path, options);
            recording->head = reader->head();
            recording->head.sample_rate_hz = sample_rate_hz.value_or(recording->head.sample_rate_hz);
            read_rows(*reader, *recording, stop);
        });
    });
    return recording;
}

/// Returns the numbers of the columns: of the one of that name, or of all of that quantity.
std::vector<std::size_t> columns_of(const Recording& recording, const std::string& name) {
    const std::vector<recordings::Column>& columns = recording.head.columns;
    const auto named = std::ranges::find(columns, name, &recordings::Column::name);
    if (named != columns.end()) {
        return {static_cast<std::size_t>(named - columns.begin())};
    }
    std::vector<std::size_t> found;
    for (std::size_t i = 0; i < columns.size(); ++i) {
        if (columns[i].quantity == name) {
            found.push_back(i);
        }
    }
    return found;
}

/// Returns the quantities, and the columns that have none.
std::string names_in(const std::vector<recordings::Column>& columns) {
    std::vector<std::string> names;
    for (const recordings::Column& column : columns) {
        const std::string& name = column.quantity.empty() ? column.name : column.quantity;
        if (std::ranges::find(names, name) == names.end()) {
            names.push_back(name);
        }
    }
    return comma_separated(names);
}

/// Returns [sample][column], copied: columns that lie anyhow are no array.
py::array_t<double> copied(const Recording& recording, const std::vector<std::size_t>& columns) {
    const std::size_t width = recording.head.columns.size();
    py::array_t<double> array(
        {static_cast<py::ssize_t>(recording.rows()), static_cast<py::ssize_t>(columns.size())});
    double* value = array.mutable_data();
    for (std::size_t row = 0; row < recording.rows(); ++row) {
        for (const std::size_t column : columns) {
            *value++ = recording.values[row * width + column];
        }
    }
    array.attr("setflags")(py::arg("write") = false);
    return array;
}

/// Returns [sample], or [sample][channel] of a quantity with several columns, or with one of several.
/// @param name of a quantity or of a column
py::array_t<double> samples_of(const std::shared_ptr<Recording>& recording, const std::string& name) {
    const std::vector<std::size_t> columns = columns_of(*recording, name);
    if (columns.empty()) {
        throw py::key_error("found " + quoted_briefly(name) +
                            ", allowed: " + names_in(recording->head.columns));
    }
    const std::size_t channels = columns.size();
    const std::size_t width = recording->head.columns.size();
    const std::size_t rows = recording->rows();
    std::vector<py::ssize_t> shape{static_cast<py::ssize_t>(rows)};
    std::vector<py::ssize_t> strides{static_cast<py::ssize_t>(width)};
    const auto tap = tap_named(name);
    if (channels > 1 ||
        (tap && recording->head.columns[columns[0]].name != name && has_channels(*tap, {1, 1, 1}))) {
        shape.push_back(static_cast<py::ssize_t>(channels));
    }
    // the columns of several quantities may take turns: x1, v1, x2, v2
    const std::size_t apart = channels > 1 ? columns[1] - columns[0] : 1;
    for (std::size_t i = 1; i < channels; ++i) {
        if (columns[i] - columns[i - 1] != apart) {
            return copied(*recording, columns);
        }
    }
    if (shape.size() > 1) {
        strides.push_back(static_cast<py::ssize_t>(apart));
    }
    return view_of(recording->values.data() + columns[0], shape, py::cast(recording), strides);
}

using Rows = py::array_t<double, py::array::c_style | py::array::forcecast>;

py::list columns_list(const Recording& recording) {
    py::list columns;
    for (const recordings::Column& column : recording.head.columns) {
        columns.append(py::make_tuple(column.name, column.quantity, column.unit));
    }
    return columns;
}

py::list stretches_list(const Recording& recording) {
    py::list stretches;
    for (const Stretch& stretch : recording.stretches) {
        stretches.append(py::make_tuple(stretch.first, stretch.row));
    }
    return stretches;
}

/// Returns all of a recording for pickle; JSON as text, which keeps every number.
py::tuple state_of_recording(const std::shared_ptr<Recording>& recording) {
    const std::vector<py::ssize_t> shape{static_cast<py::ssize_t>(recording->values.size())};
    return py::make_tuple(
        columns_list(*recording), recording->head.sample_rate_hz, json_text(recording->head.provenance),
        view_of(recording->values.data(), shape, py::cast(recording)), stretches_list(*recording));
}

std::shared_ptr<Recording> restored_recording(const py::tuple& state) {
    auto recording = std::make_shared<Recording>();
    for (const auto& [name, quantity, unit] :
         state[0].cast<std::vector<std::tuple<std::string, std::string, std::string>>>()) {
        recording->head.columns.push_back({name, quantity, unit});
    }
    recording->head.sample_rate_hz = state[1].cast<double>();
    recording->head.provenance = json_from_outside(state[2].cast<std::string>());
    const auto values = state[3].cast<Rows>();
    recording->values.assign(values.data(), values.data() + values.size());
    for (const auto& [first, row] : state[4].cast<std::vector<std::pair<std::int64_t, std::size_t>>>()) {
        recording->stretches.push_back({first, row});
    }
    return recording;
}

}  // namespace

void add_load(py::module_& module) {
    py::class_<Recording, std::shared_ptr<Recording>>(module, "Recording")
        .def_property_readonly("sample_rate_hz",
                               [](const Recording& recording) { return recording.head.sample_rate_hz; })
        .def_property_readonly("rows", &Recording::rows)
        .def_property_readonly("warnings",
                               [](const Recording& recording) {
                                   py::list warnings;
                                   for (const std::string& warning : recording.warnings) {
                                       warnings.append(text_of(warning));
                                   }
                                   return warnings;
                               })
        .def_property_readonly("columns", &columns_list)
        .def_property_readonly("stretches", &stretches_list)
        .def("provenance",
             [](const Recording& recording) { return python_object(recording.head.provenance); })
        .def("samples", &samples_of, py::arg("name"))
        .def("__reduce_ex__", &reduced)
        .def(py::pickle(&state_of_recording, &restored_recording));
    module.def("load", &load, py::arg("path"), py::arg("sample_rate_hz") = py::none());
}

}  // namespace hertzline::python
