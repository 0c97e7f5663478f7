#pragma once
// Where in an HDF5 file a recording's columns are.

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "recordings/formats/hdf5/hdf5_library.hpp"
#include "recordings/recording.hpp"

namespace hertzline::recordings {

/// The dataset of the recording's start and of its continuations after gaps.
inline constexpr const char* hdf5_captures = "captures";

/// The dataset that lists changes of the scene, if there are any: bytes, JSON on a line each.
inline constexpr const char* hdf5_changes = "changes";

/// A dataset and the columns that it holds, in order.
struct Hdf5Quantity {
    std::string name;
    std::string unit;
    std::vector<std::size_t> columns;
    bool of_spheres = false;  // a row for each sample, also where there is one sphere
    Hdf5Object dataset{};
};

std::vector<Hdf5Quantity> hdf5_quantities(const RecordingHead& head);

/// How numbers are in the file.
hid_t hdf5_type(NumberType numbers);

/// Gives an object an attribute.
void hdf5_write_text(hid_t object, const char* name, const std::string& text);

/// Reads such an attribute. @throws std::runtime_error when it is no text
std::string hdf5_read_text(hid_t object, const char* name);

/// An empty dataset whose rows may be many. @param rank 1: of numbers; 2: of rows with so many columns
Hdf5Object hdf5_create_dataset(hid_t file, const std::string& name, hid_t type, int rank, hsize_t columns,
                               std::array<hsize_t, 2> chunk);

/// Makes the dataset so many rows longer than `row`, and writes them. @param type of the values in memory
void hdf5_append_rows(hid_t dataset, hid_t type, std::int64_t row, std::int64_t rows, std::size_t columns,
                      const void* values);

/// Consecutive rows of a dataset, in memory and in the file.
struct Hdf5Rows {
    Hdf5Rows(hid_t dataset, std::int64_t row, std::int64_t rows);
    Hdf5Object file;
    Hdf5Object memory;
};

}  // namespace hertzline::recordings
