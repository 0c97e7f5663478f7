#pragma once
// What `stream` and `replay` have in common: how samples are published, wherever they come from.

#include <functional>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>

#include "apps/arguments/curve_arguments.hpp"
#include "apps/command.hpp"
#include "apps/console/output.hpp"
#include "apps/console/progress.hpp"
#include "stream/pipeline/pipeline.hpp"

namespace hertzline::app {

struct StreamingRequest {
    std::string endpoint = "tcp://127.0.0.1:5573";
    CurveServerRequest curve;
    std::string pace = "realtime";
    std::optional<double> duration_s;
    stream::StreamStart start = stream::StreamStart::at_once;
    std::optional<stream::OnOverrun> on_overrun;
    stream::ThreadOptions thread;
    Format format = Format::text;
};

/// Adds all of the above to a subcommand.
void add_streaming_options(CLI::App& command, StreamingRequest& request);

/// @throws WrongUse that names every fault; reads the keys that are asked for.
std::optional<stream::CurveServer> checked(const StreamingRequest& request);

/// @param by_default what becomes of blocks that are late when the user did not say
stream::StreamOptions plan_of(const StreamingRequest& request, double sample_rate_hz,
                              stream::OnOverrun by_default);

stream::PublisherOptions publisher_options(const stream::StreamFormat& format,
                                           std::optional<stream::CurveServer> curve);

/// Streams to the end, tells the user what there is to know on the way, and prints the summary, to which
/// `add` adds what only the caller knows.
void stream_to_the_end(stream::Pipeline& pipeline, const stream::Publisher& publisher, ProgressLine& line,
                       Format format, const std::function<void(Json&, const stream::StreamMeters&)>& add);

}  // namespace hertzline::app
