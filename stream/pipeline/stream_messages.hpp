#pragma once
// The messages that tell subscribers what a stream is and how it is doing.

#include <string>

#include "core/scene/json.hpp"
#include "core/taps.hpp"
#include "stream/inputs/sample_source.hpp"
#include "stream/pipeline/stream_monitor.hpp"
#include "stream/pipeline/stream_options.hpp"

namespace hertzline::stream {

/// The message of the meta topic: format, streams, units, and what the options say about the samples.
std::string meta_json(const StreamOptions& options, const StreamFormat& format);

/// What meters and summary say alike: how the stream keeps time and what it has sent, as flat members.
void add_stream_members(Json& object, const StreamMeters& meters, TapSet taps);

/// The message of the meters topic.
std::string meters_json(const StreamMeters& meters, TapSet taps, const std::string& run);

}  // namespace hertzline::stream
