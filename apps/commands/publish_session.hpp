#pragma once
// The common part of `stream` and `replay`: publishing samples of any source.

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

/// The publishing options of `stream` and `replay`.
struct PublishRequest {
    std::string endpoint = "tcp://127.0.0.1:5573";
    CurveServerRequest curve;
    std::string pace = "realtime";
    std::optional<double> duration_s;
    stream::StreamStart start = stream::StreamStart::at_once;
    std::optional<stream::OnOverrun> on_overrun;
    std::optional<std::uint64_t> queue_bytes;
    std::optional<int> max_clients;
    stream::ThreadOptions thread;
    Format format = Format::text;
};

/// Adds these options to a subcommand. `request` must outlive the parsing. @param usual_on_overrun the default of --on-overrun, as
/// --help has it
void add_publish_options(CLI::App& app, PublishRequest& request, const std::string& usual_on_overrun);

/// Reads the keys of the request; unset when it asks for no encryption. Adds the faults of all its options.
std::optional<stream::CurveServer> checked_curve(const PublishRequest& request, Faults& faults);

/// @param on_overrun the default treatment of late blocks
stream::StreamOptions stream_options(const PublishRequest& request, double sample_rate_hz,
                                     stream::OnOverrun on_overrun);

stream::PublisherOptions publisher_options(const PublishRequest& request, const stream::StreamFormat& format,
                                           std::optional<stream::CurveServer> curve);

/// Returns the address for a listener on this machine; on others the host's name replaces 127.0.0.1.
std::string local_endpoint(std::string endpoint);

/// Returns the most bytes of ring and queues.
double stream_bytes(const stream::StreamFormat& format, stream::Pace pace,
                    const stream::PublisherOptions& options) noexcept;

/// The caller's callbacks.
struct PublishedSource {
    std::function<void(Json&, const stream::StreamMeters&)> add_to_summary;
    std::function<void()> starts = {};                      ///< as in StreamEvents
    std::function<Json(const MotionExtremes&)> watch = {};  ///< as in StreamEvents
    std::function<Json(const Epoch&)> epoch_begins = {};    ///< as in StreamEvents
    std::int64_t first_sample = 0;                          ///< from which the summary counts samples
};

/// Publishes to the end, shows progress and warnings, and prints the summary.
void publish_to_the_end(stream::Pipeline& pipeline, const stream::Publisher& publisher, ProgressLine& line,
                        Format format, const PublishedSource& source);

}  // namespace hertzline::app
