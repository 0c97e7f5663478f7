#include "tests/fuzz/recording_claims.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <string>

#include "core/scene/text.hpp"
#include "measures/provenance.hpp"
#include "stream/inputs/replay_source.hpp"
#include "tests/fuzz/claim.hpp"

namespace hertzline::fuzz {

using namespace measures;
using namespace recordings;
using namespace stream;

namespace {

constexpr std::size_t longest_message = 500;  // or of the name of a column
constexpr std::int64_t max_rows = 10'000;     // more of the same would show nothing new
constexpr std::size_t portion = 7;

void claim_head(const RecordingHead& head) {
    claim(!head.columns.empty(), "a recording has columns");
    for (const Column& column : head.columns) {
        const std::string names = column.name + ", " + column.quantity + ", " + column.unit;
        claim_message(names, longest_message);
        claim(is_plain(names), "columns have names in UTF-8 that can be shown", names);
    }
    claim(provenance_of_meta(head.provenance).is_object(), "a replay can say where its samples come from");
    claim(std::isfinite(head.sample_rate_hz) && head.sample_rate_hz >= 0, "a rate is a number");
}

/// Returns the number of rows.
std::int64_t claim_rows(RecordingReader& reader) {
    const std::size_t columns = reader.head().columns.size();
    std::int64_t count = 0;
    std::int64_t due = 0;
    for (RecordedRows rows; count < max_rows && reader.read(rows, portion);) {
        claim(!rows.values.empty() && rows.values.size() % columns == 0, "rows are whole");
        claim(rows.values.size() <= portion * columns, "rows are not more than were asked for");
        claim(rows.first >= due, "rows never go back");
        claim(std::all_of(rows.values.begin(), rows.values.end(), [](double v) { return std::isfinite(v); }),
              "samples are finite");
        const auto taken = static_cast<std::int64_t>(rows.values.size() / columns);
        due = rows.first + taken;
        count += taken;
    }
    return count;
}

void claim_replay(std::unique_ptr<RecordingReader> reader, std::int64_t rows) {
    const double told_hz = reader->head().sample_rate_hz;  // 0: it does not tell
    ReplaySource source(std::move(reader), told_hz > 0 ? told_hz : 1, portion);
    const TapSet taps = source.format().taps;
    Samples samples = source.make_block(taps);
    std::int64_t count = 0;
    while (count < max_rows && source.read(samples, portion, taps)) {
        count += static_cast<std::int64_t>(samples.count);
    }
    claim(std::min(count, max_rows) == std::min(rows, max_rows), "a replay has the recording's samples");
}

}  // namespace

std::unique_ptr<RecordingReader> open_as_a_user(const std::filesystem::path& path) {
    return open_reader(path, {.sample_rate_hz = std::nullopt, .warn = [](const std::string& warning) {
                                  claim_message(warning, longest_message);
                              }});
}

void claim_recording_or_fault(const std::filesystem::path& path, const OpenRecording& open) {
    try {
        const auto reader = open(path);
        claim_head(reader->head());
        if (const std::int64_t rows = claim_rows(*reader); rows > 0) {
            claim_replay(open(path), rows);
        }
    } catch (const std::runtime_error& error) {
        claim_message(error.what(), longest_message);
    }
}

}  // namespace hertzline::fuzz
