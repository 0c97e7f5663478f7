#include "apps/commands/run/run_record.hpp"

#include <algorithm>
#include <iterator>
#include <span>

#include "stream/measures/spectrum.hpp"

namespace hertzline::app {

RunRecord empty_record(TapSet measured, const EndModel& end, std::size_t rows) {
    RunRecord record;
    record.taps.push_back({Tap::v_out, {}});
    for (const Tap tap : measured - Tap::v_out) {
        record.taps.push_back({tap, {}});
    }
    for (TapRecord& tap : record.taps) {
        tap.values.reserve(rows);
    }
    record.v_out_smooth.reserve(end.has_plate ? rows : 0);
    return record;
}

void keep(const Samples& block, const EndModel& end, RunRecord& record) {
    record.peak_v_last = std::max(record.peak_v_last, stream::peak_of(block[Tap::v_last]));
    for (TapRecord& tap : record.taps) {
        const std::span<const double> values = block[tap.tap];
        tap.values.insert(tap.values.end(), values.begin(), values.end());
    }
    if (end.has_plate) {
        std::ranges::transform(
            block[Tap::v_last], block[Tap::v_plate], std::back_inserter(record.v_out_smooth),
            [&end](double v_last, double v_plate) { return end.output_velocity(v_last, v_plate, true); });
    }
}

}  // namespace hertzline::app
