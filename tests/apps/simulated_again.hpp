#pragma once
// Recordings of changed scenes, which `run` simulates again.

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/scene/json.hpp"
#include "recordings/recording_formats.hpp"
#include "tests/apps/program.hpp"

namespace hertzline::test {

/// Returns all numbers of a recording, in order.
inline std::vector<double> numbers_in(const std::string& file) {
    const auto reader = recordings::open_reader(file);
    std::vector<double> all;
    for (recordings::RecordedRows rows; reader->read(rows, 4096);) {
        all.insert(all.end(), rows.values.begin(), rows.values.end());
    }
    return all;
}

/// Returns the changes of the scene that a recording names.
inline Json changes_in_file(const std::string& file) {
    return recordings::open_reader(file)->head().provenance.value("changes", Json::array());
}

/// Repeats the session of a recording by `run`.
inline std::vector<double> simulated_again(const std::string& file, const std::string& as,
                                           const std::string& columns = "v_out") {
    const Outcome run = hertzline({"run", file, "--columns", columns, "-o", as});
    EXPECT_EQ(run.status, 0) << run.err;
    return numbers_in(as);
}

}  // namespace hertzline::test
