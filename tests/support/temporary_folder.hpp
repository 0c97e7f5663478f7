#pragma once

#include <filesystem>
#include <random>
#include <string>

#include <fmt/format.h>

namespace hertzline::test {

/// A folder of a test, removed after it. Its path is short, because a socket's path may have only 107 bytes.
class TemporaryFolder {
public:
    TemporaryFolder() : path_(std::filesystem::temp_directory_path() / unique_name()) {
        std::filesystem::create_directory(path_);
    }
    ~TemporaryFolder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;

    std::string file(const std::string& name) const { return path_ / name; }

private:
    static std::string unique_name() {
        std::random_device random;
        return fmt::format("hertzline-{:08x}{:08x}", random(), random());
    }
    std::filesystem::path path_;
};

}  // namespace hertzline::test
