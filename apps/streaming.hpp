#pragma once
// What `stream` and `replay` have in common: how samples are published, wherever they come from.

#include <functional>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>

#include "apps/commands.hpp"
#include "apps/curve_arguments.hpp"
#include "apps/output.hpp"
#include "apps/progress.hpp"
#include "stream/pipeline.hpp"

namespace hertzline::app {

struct StreamingRequest {
    std::string endpoint = "tcp://127.0.0.1:5573";
    CurveServerRequest curve;
    std::string pace = "realtime";
    std::optional<double> duration_s;
    StreamStart start = StreamStart::at_once;
    std::optional<OnOverrun> on_overrun;
    ThreadWishes thread;
    Format format = Format::text;
};

/// Adds all of the above to a subcommand.
void add_streaming_options(CLI::App& command, StreamingRequest& request);

/// Throws WrongUse that names every fault; reads the keys that are asked for.
std::optional<CurveServer> checked(const StreamingRequest& request);

/// @param by_default what becomes of blocks that are late when the user did not say
StreamPlan plan_of(const StreamingRequest& request, double sample_rate_hz, OnOverrun by_default);

PublisherOptions publisher_options(const StreamFormat& format, std::optional<CurveServer> curve);

/// Streams to the end, tells the user what there is to know on the way, and prints the summary, to which
/// `add` adds what only the caller knows.
void stream_to_the_end(Pipeline& pipeline, const Publisher& publisher, ProgressLine& line, Format format,
                       const std::function<void(Json&, const StreamMeters&)>& add);

}  // namespace hertzline::app
