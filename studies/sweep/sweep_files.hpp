#pragma once
// The files of a sweep: HDF5 or CSV, by the ending of the name.

#include <atomic>
#include <filesystem>
#include <optional>
#include <string>

#include "studies/sweep/sweep_table.hpp"

namespace hertzline::studies {

/// Why no sweep can have that name; nothing when it can. @param with_waveforms only HDF5 holds them
std::optional<std::string> sweep_file_fault(const std::filesystem::path& path, bool with_waveforms);

/// Bytes of the file, from above.
double sweep_file_bytes(const std::filesystem::path& path, const Sweep& sweep);

/// Writes all points, which must be there. The file has its name when it is complete, and the same bytes whenever it is written. False,
/// and nothing is left, once `stop` is true.
/// @throws std::runtime_error that names the path and the reason; then nothing is left, either
bool write_sweep(const std::filesystem::path& path, const SweepTable& table, const std::atomic<bool>& stop);

}  // namespace hertzline::studies
