#pragma once
// RecordingSet that the tests of every format write and expect back.

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "stream/recordings/recording.hpp"

namespace hertzline::test {

/// Two velocities, then displacement and velocity of each sphere, as a run writes them.
inline stream::RecordingHead recording_head(stream::NumberType numbers, int spheres = 0) {
    stream::RecordingHead head;
    head.sample_rate_hz = 10e6;
    head.numbers = numbers;
    head.provenance = {{"version", "1.2.3"}, {"scene", {{"chain", {{"spheres", spheres}}}}}};
    head.columns = {{"v_last_m_per_s", "v_last", "m/s"}, {"v_out_m_per_s", "v_out", "m/s"}};
    for (int i = 1; i <= spheres; ++i) {
        head.columns.push_back({"x" + std::to_string(i) + "_m", "x_chain", "m"});
        head.columns.push_back({"v" + std::to_string(i) + "_m_per_s", "v_chain", "m/s"});
    }
    return head;
}

/// Rows that use all bits of their numbers; different for every sample and column.
inline stream::RecordedRows recorded_rows(const stream::RecordingHead& head, std::int64_t first,
                                          std::size_t rows) {
    stream::RecordedRows made{first, {}};
    for (std::size_t i = 0; i < rows * head.columns.size(); ++i) {
        const double value = std::sin(static_cast<double>(first) + 0.7 * static_cast<double>(i)) *
                             std::pow(10.0, -static_cast<double>(i % 20));
        made.values.push_back(head.numbers == stream::NumberType::float32 ? static_cast<float>(value)
                                                                          : value);
    }
    return made;
}

inline void write_rows(stream::RecordingWriter& writer, const std::vector<stream::RecordedRows>& rows) {
    for (const stream::RecordedRows& block : rows) {
        writer.write(block.first, block.values);
    }
}

/// All rows, joined where nothing is missing between them, whatever the reader's portions were.
inline std::vector<stream::RecordedRows> read_rows(stream::RecordingReader& reader, std::size_t most = 1000) {
    const std::size_t columns = reader.head().columns.size();
    std::vector<stream::RecordedRows> all;
    for (stream::RecordedRows rows; reader.read(rows, most);) {
        const bool continues =
            !all.empty() &&
            all.back().first + static_cast<std::int64_t>(all.back().values.size() / columns) == rows.first;
        if (continues) {
            all.back().values.insert(all.back().values.end(), rows.values.begin(), rows.values.end());
        } else {
            all.push_back(rows);
        }
    }
    return all;
}

}  // namespace hertzline::test
