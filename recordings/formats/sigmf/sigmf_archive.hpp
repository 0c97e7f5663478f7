#pragma once
// SigMF archives: a recording's two files in an uncompressed tar, x.sigmf.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "recordings/files/input_file.hpp"

namespace hertzline::recordings {

/// A file within another one.
struct ArchivedFile {
    std::string name;  ///< without folders
    std::uint64_t begin = 0;
    std::uint64_t size = 0;
};

/// Returns the files in a tar: ustar, with the long names and sizes of GNU and POSIX.1-2001. @throws std::runtime_error that
/// names the path and the fault
std::vector<ArchivedFile> files_of_tar(InputFile& tar);

}  // namespace hertzline::recordings
