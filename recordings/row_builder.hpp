#pragma once
// Blocks of a simulation to recordings, as rows.

#include <vector>

#include "recordings/columns.hpp"
#include "recordings/recording_set.hpp"

#include "core/samples.hpp"

namespace hertzline::recordings {

/// Turns blocks of samples into the rows of recordings.
class RowBuilder {
public:
    /// @param recordings outlives the builder; its columns are recorded_columns() of the same taps
    RowBuilder(RecordingSet& recordings, TapSet taps);

    TapSet taps() const noexcept { return taps_; }

    /// Appends a block that holds the taps. Does not throw when a recording cannot be written: `recordings` reports
    /// that.
    void write(const Samples& block);

private:
    RecordingSet& recordings_;
    TapSet taps_;
    std::vector<Tap> single_;       ///< of one channel
    std::vector<Tap> per_sphere_;   ///< a channel each
    std::vector<Tap> per_contact_;  ///< a channel each
};

}  // namespace hertzline::recordings
