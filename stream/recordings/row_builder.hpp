#pragma once
// Blocks of a simulation to recordings, as rows.

#include <vector>

#include "core/samples.hpp"
#include "stream/recordings/columns.hpp"
#include "stream/recordings/recording_set.hpp"

namespace hertzline::stream {

/// Makes the rows of a recording from the blocks of a simulation.
class RowBuilder {
public:
    /// @param recordings outlives the recorder; its columns are recorded_columns() of the same bodies
    RowBuilder(RecordingSet& recordings, RecordedBodies bodies) : recordings_(recordings), bodies_(bodies) {}

    /// Appends a block that holds the outputs (and for RecordedBodies::all the whole chain). Does not throw
    /// when a recording cannot be written: `recordings` tells.
    void write(const Samples& block);

private:
    RecordingSet& recordings_;
    RecordedBodies bodies_;
    std::vector<double> rows_;
};

}  // namespace hertzline::stream
