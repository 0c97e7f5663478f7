#pragma once
// Texts of files, and how many files a folder has.

#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>

namespace hertzline::test {

/// Reads the bytes of a file.
inline std::string contents(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    std::ostringstream text;
    text << in.rdbuf();
    return text.str();
}

inline void write_text(const std::filesystem::path& file, const std::string& text) {
    std::ofstream(file, std::ios::binary) << text;
}

inline std::size_t files_in(const std::filesystem::path& folder) {
    return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder), {}));
}

}  // namespace hertzline::test
