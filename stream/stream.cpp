#include "hertzline/stream.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "core/model/drive.hpp"
#include "core/scene/faults.hpp"
#include "core/scene/text.hpp"
#include "measures/measuring.hpp"
#include "measures/provenance.hpp"
#include "measures/resources.hpp"
#include "measures/tap_names.hpp"
#include "stream/inputs/estimate_watch.hpp"
#include "stream/inputs/simulation_source.hpp"
#include "stream/listening/listener.hpp"
#include "stream/pipeline/capacity.hpp"
#include "stream/pipeline/pipeline.hpp"
#include "stream/pipeline/stream_messages.hpp"
#include "stream/wire/security/certificate.hpp"

namespace hertzline {

namespace {

constexpr double max_samples = 9e18;  // within 63 bits

std::optional<std::int64_t> samples_in(std::optional<double> duration_s, double sample_rate_hz) {
    if (!duration_s) {
        return std::nullopt;
    }
    const double samples = std::round(*duration_s * sample_rate_hz);
    if (!(*duration_s > 0 && samples <= max_samples)) {
        throw std::invalid_argument(fmt::format(
            "duration_s: found {}, allowed: above 0, at most {:.0e} samples", *duration_s, max_samples));
    }
    return static_cast<std::int64_t>(std::max(1.0, samples));
}

/// The keys of the certificates. @throws std::runtime_error with every fault
std::optional<stream::CurveClient> keys_of(const ListenOptions& options) {
    Faults faults;
    auto keys =
        stream::read_client_keys(options.curve_key, options.server_key, "curve_key", "server_key", faults);
    faults.refuse<std::runtime_error>();
    return keys;
}

}  // namespace

nlohmann::ordered_json publish(const Resolution& resolved, const PublishOptions& options) {
    const ResolvedScene scene = resolved;
    for (const auto& fault :
         {awaited_samples_fault(scene.scene().drive), stream::SimulationSource::fault_of(scene.scene())}) {
        if (fault) {
            throw std::invalid_argument(fault->message());
        }
    }
    const double rate = scene.scene().output.sample_rate_hz;
    stream::StreamOptions streamed{
        .about = {},
        .pace = options.pace == 0 ? stream::Pace::flat_out() : stream::Pace::factor(options.pace),
        .samples = samples_in(options.duration_s, rate),
        .start = options.wait_for_subscriber ? stream::StreamStart::with_first_subscriber
                                             : stream::StreamStart::at_once};
    streamed.about = measures::provenance_json(resolved, streamed.run);
    stream::SimulationSource source(scene.scene(), {});
    stream::PublisherOptions limits;
    limits.queue_bytes = stream::usual_queue_bytes(measures::available_memory_bytes());
    limits.largest_message = stream::largest_frame_bytes(source.format());
    stream::Publisher publisher(options.endpoint, stream::all_topics, limits);
    const auto warn = options.warn ? options.warn : [](const std::string&) {};
    for (const std::string& text : measures::scene_warnings(resolved)) {
        warn(text);
    }
    if (options.bound) {
        options.bound(publisher.endpoint());
    }
    stream::EstimateWatch watch(resolved);
    stream::Pipeline pipeline(std::move(streamed), source, publisher, nullptr);
    nlohmann::ordered_json summary;
    bool late = false;
    const std::atomic<bool> never = false;
    pipeline.run(options.stop != nullptr ? *options.stop : never,
                 {.progress =
                      [&](const stream::StreamMeters& meters) {
                          if (!late && meters.largest_lateness_s > stream::too_late_s) {
                              late = true;
                              warn(stream::lateness_text(meters));
                          }
                      },
                  .warn = warn,
                  .watch =
                      [&](const MotionExtremes& motion) {
                          const stream::EstimateWatch::News news = watch.look(motion);
                          Json changed = Json::object();
                          if (!news.warning.empty()) {
                              warn(news.warning);
                          }
                          if (news.estimated_again) {
                              measures::add_estimate(changed, watch.estimate());
                          }
                          return changed;
                      },
                  .summary =
                      [&](const stream::StreamMeters& meters) {
                          if (const auto news = watch.finish(meters.motion); !news.warning.empty()) {
                              warn(news.warning);
                          }
                          summary = stream::summary_json(meters, pipeline, publisher);
                          stream::add_simulation(summary, meters, scene.scene(), watch.estimate(),
                                                 Json::array());
                          return json_text(summary);
                      }});
    return summary;
}

namespace {

ListenOptions checked(ListenOptions options) {
    Faults faults;
    faults.add("timeout_s", positive_fault(options.timeout_s, "[s]"));
    if (options.taps.empty() || !(options.taps - streamed_taps).empty()) {
        faults.add("taps", "found " + quoted_briefly(comma_separated(measures::names_of(options.taps))) +
                               ", allowed: one or more of " +
                               comma_separated(measures::names_of(streamed_taps)));
    }
    faults.refuse<std::invalid_argument>();
    return options;
}

}  // namespace

struct Listener::Connection {
    Connection(const std::string& endpoint, ListenOptions options)
        : listener(endpoint, {.taps = options.taps,
                              .timeout_s = options.timeout_s,
                              .curve = keys_of(options),
                              .notify = std::move(options.notify)}) {}

    stream::Listener listener;
    StreamFrame frame{};
};

Listener::Listener(const std::string& endpoint, ListenOptions options)
    : connection_(std::make_unique<Connection>(endpoint, checked(std::move(options)))) {}
Listener::~Listener() = default;
Listener::Listener(Listener&&) noexcept = default;
Listener& Listener::operator=(Listener&&) noexcept = default;

const StreamFrame* Listener::receive(std::chrono::milliseconds patience) {
    stream::ReceivedFrame* received = connection_->listener.receive(patience);
    if (received == nullptr) {
        return nullptr;
    }
    StreamFrame& frame = connection_->frame;
    frame = {.tap = received->tap,
             .run = received->header.run,
             .first_sample = received->header.sample,
             .sample_rate_hz = received->header.fs,
             .channels = received->header.channels,
             .missing = received->missing,
             .values = std::move(received->values)};
    return &frame;
}

bool Listener::ended() const noexcept {
    return connection_->listener.ended();
}

bool Listener::complete() const noexcept {
    return std::ranges::all_of(connection_->listener.runs(),
                               [](const auto& run) { return run.second.complete(); });
}

std::string Listener::text() const {
    std::string text;
    for (const auto& [tap, run] : connection_->listener.runs()) {
        text += fmt::format("{}{}: {}", text.empty() ? "" : "\n", row_of(tap).name, run.text());
        if (run.end_reason() != stream::EndReason::none) {
            text += fmt::format("; ended by {}", word(run.end_reason()));
        }
    }
    return text;
}

}  // namespace hertzline
