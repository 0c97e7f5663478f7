#pragma once
// An HDF5 file that is written at once.

#include <filesystem>
#include <functional>

#include "recordings/formats/hdf5/hdf5_functions.hpp"

namespace hertzline::recordings {

/// Writes it under a temporary name, and gives it its own when it is whole.
/// @param fill writes the contents; false: it was stopped, and no file is left
/// @returns the result of fill @throws std::system_error that names the path if it cannot be written
bool write_whole_hdf5(const std::filesystem::path& path, const std::function<bool(hid_t file)>& fill);

}  // namespace hertzline::recordings
