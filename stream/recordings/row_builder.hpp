#pragma once
// Blocks of a simulation to recordings, as rows. What is in a row has the same names everywhere: they are
// those of the CSV.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/samples.hpp"
#include "core/taps.hpp"
#include "stream/recordings/recording_set.hpp"

namespace hertzline::stream {

/// The columns of a recording of those taps: first those with one channel, then those of the spheres, sphere by sphere.
std::vector<Column> recorded_columns(TapSet taps, std::size_t spheres);

/// The column of that name; one that is no tap's is a quantity of its own, its unit taken from the name.
Column column_named(const std::string& name);

/// Turns blocks of samples into the rows of recordings.
class RowBuilder {
public:
    /// @param recordings outlives the builder; its columns are recorded_columns() of the same taps
    RowBuilder(RecordingSet& recordings, TapSet taps);

    /// Appends a block that holds the taps. Does not throw when a recording cannot be written: `recordings` tells.
    void write(const Samples& block);

private:
    RecordingSet& recordings_;
    std::vector<Tap> single_;      ///< taps of one channel
    std::vector<Tap> per_sphere_;  ///< taps of a channel per sphere
    std::vector<double> rows_;
};

}  // namespace hertzline::stream
