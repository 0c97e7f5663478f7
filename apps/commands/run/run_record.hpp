#pragma once
// What is kept of a run for its summary, its spectra and its picture.

#include <chrono>
#include <cstddef>
#include <vector>

#include "core/model/end.hpp"
#include "core/samples.hpp"
#include "core/taps.hpp"
#include "stream/pipeline/pacer.hpp"

namespace hertzline::app {

/// A tap's samples from the start to the end.
struct TapRecord {
    Tap tap;
    std::vector<double> values;
};

struct RunRecord {
    std::vector<TapRecord> taps;       ///< v_out, then the others that are measured
    std::vector<double> v_out_smooth;  ///< with a plate: v_out as if the last contact never opened
    double peak_v_last = 0;            ///< [m/s]
    stream::Nanoseconds busy{0};       ///< simulating
    bool stopped = false;              ///< by the user, before the end

    std::size_t rows() const { return taps.front().values.size(); }
    double wall_s() const { return std::chrono::duration<double>(busy).count(); }
};

/// With room for so many rows.
RunRecord empty_record(TapSet measured, const EndModel& end, std::size_t rows);

/// Takes the next samples.
void keep(const Samples& block, const EndModel& end, RunRecord& record);

}  // namespace hertzline::app
