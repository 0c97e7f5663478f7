#pragma once
// Recordings that the tests of every format write and expect back.

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "recordings/columns.hpp"
#include "recordings/recording.hpp"
#include "tests/support/files.hpp"

namespace hertzline::test {

/// Two velocities, then displacement and velocity of each sphere, as a run writes them.
inline recordings::RecordingHead recording_head(recordings::NumberType numbers, int spheres = 0) {
    recordings::RecordingHead head;
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

/// Makes columns of these names.
inline recordings::RecordingHead recording_head(
    const std::vector<std::string>& names, double sample_rate_hz,
    recordings::NumberType numbers = recordings::NumberType::float64) {
    recordings::RecordingHead head;
    for (const std::string& name : names) {
        head.columns.push_back(recordings::column_named(name));
    }
    head.sample_rate_hz = sample_rate_hz;
    head.numbers = numbers;
    head.provenance = {{"version", "1"}, {"scene", {{"chain", {{"spheres", 6}}}}}};
    return head;
}

/// Makes rows that use all bits of their numbers. A row depends on its sample's index alone.
inline recordings::RecordedRows recorded_rows(const recordings::RecordingHead& head, std::int64_t first,
                                              std::size_t rows) {
    recordings::RecordedRows made{first, {}};
    const std::size_t columns = head.columns.size();
    for (std::size_t i = 0; i < rows * columns; ++i) {
        const auto sample = static_cast<double>(first + static_cast<std::int64_t>(i / columns));
        const double value = std::sin(sample + 0.7 * static_cast<double>(i % columns)) *
                             std::pow(10.0, -static_cast<double>(i % columns % 20));
        made.values.push_back(head.numbers == recordings::NumberType::float32 ? static_cast<float>(value)
                                                                              : value);
    }
    return made;
}

inline void write_rows(recordings::RecordingWriter& writer,
                       const std::vector<recordings::RecordedRows>& rows) {
    for (const recordings::RecordedRows& block : rows) {
        writer.write(block.first, block.values);
    }
}

/// Reads all rows, and joins the reader's portions where no rows are missing between them.
inline std::vector<recordings::RecordedRows> read_rows(recordings::RecordingReader& reader,
                                                       std::size_t most = 1000) {
    const std::size_t columns = reader.head().columns.size();
    std::vector<recordings::RecordedRows> all;
    for (recordings::RecordedRows rows; reader.read(rows, most);) {
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
