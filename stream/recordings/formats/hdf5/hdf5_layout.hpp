#pragma once
// Where in an HDF5 file a recording's columns are.

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "stream/recordings/formats/hdf5/hdf5_library.hpp"
#include "stream/recordings/recording.hpp"

namespace hertzline::stream {

/// The dataset that lists where the recording begins and goes on after gaps.
inline constexpr const char* hdf5_captures = "captures";

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

/// Consecutive rows of a dataset, in memory and in the file.
struct Hdf5Rows {
    Hdf5Rows(hid_t dataset, std::int64_t row, std::int64_t rows);
    Hdf5Object file;
    Hdf5Object memory;
};

}  // namespace hertzline::stream
