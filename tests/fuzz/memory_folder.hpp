#pragma once
// Bytes as files, for readers that want a path.

#include <filesystem>
#include <string>
#include <string_view>

namespace hertzline::fuzz {

/// A folder in memory, its owner's alone.
class MemoryFolder {
public:
    MemoryFolder();
    ~MemoryFolder();
    MemoryFolder(const MemoryFolder&) = delete;
    MemoryFolder& operator=(const MemoryFolder&) = delete;

    std::filesystem::path file(const std::string& name) const { return folder_ / name; }

    /// Makes a file of that name hold these bytes, no others; its owner's alone, too.
    void hold(const std::string& name, std::string_view bytes) const;

private:
    std::filesystem::path folder_;
};

}  // namespace hertzline::fuzz
