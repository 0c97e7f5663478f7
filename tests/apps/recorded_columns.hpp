#pragma once
// The numbers in a column of a recording.

#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "recordings/recording_formats.hpp"
#include "tests/support/recordings.hpp"

namespace hertzline::test {

/// Returns the column of that name of a recording without gaps.
inline std::vector<double> column(const std::string& file, const std::string& name) {
    const auto reader = recordings::open_reader(file);
    const auto& columns = reader->head().columns;
    const auto found = std::ranges::find(columns, name, &recordings::Column::name);
    EXPECT_NE(found, columns.end()) << name;
    const std::vector<recordings::RecordedRows> stretches = read_rows(*reader, 1 << 16);
    EXPECT_LE(stretches.size(), 1U) << "gaps";
    std::vector<double> values;
    if (!stretches.empty()) {
        EXPECT_EQ(stretches[0].first, 0);
        for (auto i = static_cast<std::size_t>(found - columns.begin()); i < stretches[0].values.size();
             i += columns.size()) {
            values.push_back(stretches[0].values[i]);
        }
    }
    return values;
}

inline std::vector<double> as_float32(std::vector<double> values) {
    std::ranges::transform(values, values.begin(), [](double v) { return static_cast<float>(v); });
    return values;
}

}  // namespace hertzline::test
