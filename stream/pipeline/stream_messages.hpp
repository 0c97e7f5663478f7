#pragma once
// The messages that describe a stream and its state to subscribers.

#include <optional>
#include <string>

#include "core/scene/json.hpp"
#include "hertzline/resolve.hpp"
#include "hertzline/taps.hpp"
#include "stream/inputs/sample_source.hpp"
#include "stream/pipeline/pipeline.hpp"
#include "stream/pipeline/stream_monitor.hpp"

namespace hertzline::stream {

class Pipeline;
class Publisher;

/// The message of the meta topic: format, streams, units, and the options' description of the samples.
std::string meta_json(const StreamOptions& options, const StreamFormat& format);

/// The common members of meters and summary: timing and sent frames, flat.
void add_stream_members(Json& object, const StreamMeters& meters, TapSet taps);

/// The message of the meters topic.
std::string meters_json(const StreamMeters& meters, TapSet taps, const std::string& run);

/// A stream whose frames leave later than this does not keep up [s].
inline constexpr double too_late_s = 1;
/// Returns the warning about such a stream.
std::string lateness_text(const StreamMeters& meters);

/// The summary of a stream: its message of the end topic.
Json summary_json(const StreamMeters& meters, const Pipeline& pipeline, const Publisher& publisher);

/// Adds the members of a simulation's summary. @param last scene of the stream @param estimate the worst of its scenes
/// @param recordings their states
void add_simulation(Json& summary, const StreamMeters& meters, const Scene& last,
                    const std::optional<ErrorEstimate>& estimate, Json recordings);

}  // namespace hertzline::stream
