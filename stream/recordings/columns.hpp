#pragma once
// The columns of recordings: which there are, and their names. They are the same in every format: those of the
// CSV.

#include <cstddef>
#include <string>
#include <vector>

#include "core/taps.hpp"
#include "stream/recordings/recording.hpp"

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

}  // namespace hertzline::stream
