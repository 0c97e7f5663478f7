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

/// What a recording of a run holds beside the outputs.
enum class RecordedBodies { outputs, all };

/// The columns of a run: v_last, for a plate v_plate and v_out; with all bodies x and v of each sphere.
std::vector<Column> recorded_columns(const Scene& scene, RecordedBodies bodies);

/// How many those are; counted in double, so that an absurd number of spheres is a number too.
double recorded_numbers(const Scene& scene, RecordedBodies bodies) noexcept;

/// The columns of a stream's samples.
std::vector<Column> tap_columns(Tap tap, std::size_t channels);

/// The column of that name; one that is none of the above is a quantity of its own, without a unit.
Column column_named(const std::string& name);

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
