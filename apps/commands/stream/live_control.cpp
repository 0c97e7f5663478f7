#include "apps/commands/stream/live_control.hpp"

#include <utility>

#include <fmt/format.h>

#include "apps/arguments/options.hpp"
#include "stream/wire/endpoint.hpp"

namespace hertzline::app {

void add_control_options(CLI::App& app, ControlRequest& request) {
    app.add_option("--control", request.endpoint,
                   "let hertzline set change the scene while it is streamed: where to listen for it, as "
                   "tcp://127.0.0.1:5574")
        ->check(missing_name)
        ->type_name("ENDPOINT");
    add_repeatable_option(
        app, "--allow-controllers", request.controllers,
        "with --control and --curve-key: public key of a client that may change the scene, NAME.key, or a "
        "folder of them")
        ->check(missing_name)
        ->type_name("FILE|FOLDER");
}

std::optional<stream::CurveServer> checked_control(const ControlRequest& request,
                                                   const CurveServerRequest& stream, Faults& faults) {
    if (request.endpoint.empty()) {
        if (!request.controllers.empty()) {
            faults.add("--allow-controllers needs --control ENDPOINT");
        }
        return std::nullopt;
    }
    if (const auto fault = stream::endpoint_fault(request.endpoint, stream::EndpointUse::bind)) {
        faults.add("--control", fault);
        return std::nullopt;
    }
    if (request.controllers.empty()) {
        if (!stream::is_local(request.endpoint)) {
            faults.add("--control",
                       fmt::format("{} can be reached from other machines, where anyone could "
                                   "change the scene; allowed: with --curve-key and --allow-controllers",
                                   request.endpoint));
        }
        return std::nullopt;
    }
    if (stream.key.empty()) {
        faults.add("--allow-controllers needs --curve-key, the stream's secret key");
        return std::nullopt;
    }
    return server_keys(stream.key, "--allow-controllers", request.controllers, faults);
}

LiveControl::LiveControl(const ControlRequest& request, const std::optional<stream::CurveServer>& curve,
                         const Resolution& resolved, stream::SimulationSource& source,
                         std::optional<std::int64_t> samples, stream::StreamStart start)
    : control_(resolved.requested(), resolved.scene, source, samples,
               stream::expected_real_time_factor(resolved), start == stream::StreamStart::at_once),
      server_(request.endpoint, curve, control_) {}

std::vector<stream::EpochOfChange> LiveControl::begin(const Epoch& epoch) {
    std::vector<stream::EpochOfChange> begun = control_.take_epochs(epoch);
    for (const stream::EpochOfChange& one : begun) {
        changes_.add(stream::change_json(one.change));
    }
    return begun;
}

void LiveControl::add_to(Json& meta) const {
    meta["control"] = true;
    changes_.add_to(meta);
}

std::string change_text(const stream::SceneChange& change) {
    std::string text = fmt::format("epoch {} from sample {} on:", change.epoch, change.sample);
    const char* separator = " ";
    for (const auto& [key, value] : change.set.items()) {
        if (change.was.is_null() || change.was.value(key, Json(nullptr)) != value) {
            text += fmt::format("{}{} = {}", separator, key, json_text(value));
            separator = ", ";
        }
    }
    text += *separator == ' ' ? " nothing changes" : "";
    return text + (change.goes_on ? "" : "; from static equilibrium");
}

}  // namespace hertzline::app
