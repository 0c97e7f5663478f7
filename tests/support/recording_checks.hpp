#pragma once
// Small recordings and what is expected of them, for the tests of CSV and SigMF.

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "stream/recordings/recording_formats.hpp"
#include "stream/recordings/row_builder.hpp"
#include "tests/support/recordings.hpp"

namespace hertzline::test {

inline stream::RecordingHead recording_head(const std::vector<std::string>& names, double sample_rate_hz,
                                            stream::NumberType numbers = stream::NumberType::float64) {
    stream::RecordingHead head;
    for (const std::string& name : names) {
        head.columns.push_back(stream::column_named(name));
    }
    head.sample_rate_hz = sample_rate_hz;
    head.numbers = numbers;
    head.provenance = {{"version", "1"}, {"scene", {{"chain", {{"spheres", 6}}}}}};
    return head;
}

inline std::string contents(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    std::ostringstream text;
    text << in.rdbuf();
    return text.str();
}

inline void write_text(const std::filesystem::path& file, const std::string& text) {
    std::ofstream(file, std::ios::binary) << text;
}

/// What that throws says; empty when it throws nothing.
template <class Action>
std::string error_of(Action action) {
    try {
        action();
    } catch (const std::exception& error) {
        return error.what();
    }
    return "";
}

/// `count` rows of two columns, each number another one.
inline std::vector<double> numbered_rows(std::int64_t first, std::int64_t count) {
    std::vector<double> values;
    for (std::int64_t i = first; i < first + count; ++i) {
        values.push_back(std::sin(0.1 * static_cast<double>(i)));
        values.push_back(static_cast<float>(1e-9 * std::cos(static_cast<double>(i))));
    }
    return values;
}

/// A recording of 5000 rows in three stretches reads back as it was written, in the precision of its numbers.
inline void expect_round_trip(const std::filesystem::path& file, stream::NumberType numbers) {
    const stream::RecordingHead head = recording_head({"v_last_m_per_s", "x1_m"}, 10e6, numbers);
    const auto writer = stream::open_recording(file, head);
    std::vector<stream::RecordedRows> written{{7, numbered_rows(7, 3000)},
                                              {5000, numbered_rows(5000, 1)},
                                              {1'000'000'000'000, numbered_rows(9000, 1999)}};
    for (stream::RecordedRows& stretch : written) {
        if (numbers == stream::NumberType::float32) {
            for (double& value : stretch.values) {
                value = static_cast<float>(value);
            }
        }
        const auto half = static_cast<std::ptrdiff_t>(stretch.values.size() / 4 * 2);
        writer->write(stretch.first, {stretch.values.begin(), stretch.values.begin() + half});
        writer->write(stretch.first + half / 2, {stretch.values.begin() + half, stretch.values.end()});
    }
    writer->commit();
    const auto reader = stream::open_reader(file);
    EXPECT_EQ(reader->head().columns, head.columns);
    EXPECT_EQ(reader->head().sample_rate_hz, head.sample_rate_hz);
    EXPECT_EQ(reader->head().numbers, head.numbers);
    EXPECT_EQ(reader->head().provenance, head.provenance);
    const std::vector<stream::RecordedRows> read = read_rows(*reader, 701);
    ASSERT_EQ(read.size(), written.size());
    for (std::size_t i = 0; i < read.size(); ++i) {
        EXPECT_EQ(read[i].first, written[i].first);
        EXPECT_EQ(read[i].values, written[i].values) << "stretch " << i;
    }
}

}  // namespace hertzline::test
