#pragma once
// The columns of recordings, the same in every format, and the rows of a block of samples.

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "hertzline/samples.hpp"
#include "hertzline/taps.hpp"
#include "recordings/recording.hpp"
#include "recordings/recording_set.hpp"

namespace hertzline::recordings {

/// The columns of a recording of those taps: first those of an array's elements, element by element, then those with one channel, those of the points, of the spheres, sphere by
/// sphere, and of the contacts.
std::vector<Column> recorded_columns(TapSet taps, const ChannelCounts& counts);

/// The column of that name; one that is no tap's is a quantity of its own, its unit taken from the name.
Column column_named(const std::string& name);

/// The column of a foreign name, which may have its unit in brackets: "Channel 1 (V)", "x [um]".
Column column_titled(std::string_view title);

/// Turns blocks of samples into the rows of recordings.
class RowBuilder {
public:
    /// @param recordings outlives the builder; its columns are recorded_columns() of the same taps
    RowBuilder(RecordingSet& recordings, TapSet taps) : recordings_(recordings), taps_(taps) {}

    TapSet taps() const noexcept { return taps_; }

    /// Appends a block; one that does not hold all of the taps becomes a gap. Does not throw when a recording cannot be written: `recordings` reports
    /// that.
    void write(const Samples& block);

private:
    void find_order(const ChannelCounts& counts);

    RecordingSet& recordings_;
    TapSet taps_;
    std::vector<std::vector<Tap>> alike_;  ///< taps whose channels take turns
};

}  // namespace hertzline::recordings
