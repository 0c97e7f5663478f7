#pragma once
// Bytes as a file, for readers that want a path.

#include <cstddef>
#include <cstdint>
#include <filesystem>

namespace hertzline::fuzz {

/// A file in memory under a name of its own, with the ending that readers go by. Its owner's alone.
class MemoryFile {
public:
    explicit MemoryFile(const char* name);
    ~MemoryFile();
    MemoryFile(const MemoryFile&) = delete;
    MemoryFile& operator=(const MemoryFile&) = delete;

    /// Replaces what it holds.
    void hold(const std::uint8_t* data, std::size_t size) const;
    const std::filesystem::path& path() const noexcept { return path_; }

private:
    std::filesystem::path folder_;
    std::filesystem::path path_;
    int descriptor_;
};

}  // namespace hertzline::fuzz
