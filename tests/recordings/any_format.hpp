#pragma once
// Tests of every recording format: a fixture and the formats as its parameters.

#include <filesystem>
#include <ostream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "recordings/columns.hpp"
#include "tests/support/recordings.hpp"
#include "tests/support/temporary_folder.hpp"

namespace hertzline::test {

struct Format {
    const char* ending;
    recordings::NumberType numbers;
    friend void PrintTo(const Format& format, std::ostream* out) { *out << format.ending; }
};

constexpr Format npy_f8{"npy", recordings::NumberType::float64},
    npy_f4{"npy", recordings::NumberType::float32};
constexpr Format h5_f8{"h5", recordings::NumberType::float64}, h5_f4{"h5", recordings::NumberType::float32};
constexpr Format csv_f8{"csv", recordings::NumberType::float64},
    csv_f4{"csv", recordings::NumberType::float32};
constexpr Format wav{"wav", recordings::NumberType::float32};
constexpr Format sigmf{"sigmf-meta", recordings::NumberType::float32};
constexpr Format sigmf_collection{"sigmf-collection", recordings::NumberType::float32};

class AnyFormat : public testing::TestWithParam<Format> {
protected:
    TemporaryFolder folder;
    std::string file = folder.file(std::string("recording.") + GetParam().ending);

    recordings::RecordingHead head(int spheres = 0) const {
        return recording_head(GetParam().numbers, spheres);
    }

    /// Returns the names of the files beside the recording.
    std::vector<std::string> listing() const {
        std::vector<std::string> names;
        for (const auto& entry :
             std::filesystem::directory_iterator(std::filesystem::path(file).parent_path())) {
            names.push_back(entry.path().filename());
        }
        return names;
    }
};

inline void expect_same(const std::vector<recordings::RecordedRows>& read,
                        const std::vector<recordings::RecordedRows>& written) {
    ASSERT_EQ(read.size(), written.size());
    for (std::size_t i = 0; i < read.size(); ++i) {
        EXPECT_EQ(read[i].first, written[i].first);
        EXPECT_TRUE(read[i].values == written[i].values) << "stretch " << i;
    }
}

}  // namespace hertzline::test
