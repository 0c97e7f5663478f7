#include "apps/commands/stream/live_control.hpp"

#include <utility>

#include <fmt/format.h>

#include "apps/arguments/options.hpp"
#include "stream/wire/endpoint.hpp"
#include "stream/wire/security/certificate.hpp"

namespace hertzline::app {

namespace {

// Bounds the changes in meta, which is sent once a second. Listeners read at most 1 MiB of it.
constexpr std::size_t most_told = 500;
constexpr std::size_t most_told_bytes = 512 << 10;

}  // namespace

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
                                                   const CurveServerRequest& stream) {
    if (request.endpoint.empty()) {
        if (!request.controllers.empty()) {
            throw WrongUse("--allow-controllers needs --control ENDPOINT");
        }
        return std::nullopt;
    }
    if (const auto fault = stream::endpoint_fault(request.endpoint, stream::EndpointUse::bind)) {
        throw WrongUse("--control: " + *fault);
    }
    if (request.controllers.empty()) {
        if (!stream::is_local(request.endpoint)) {
            throw WrongUse(
                fmt::format("--control: {} can be reached from other machines, where anyone could "
                            "change the scene; allowed: with --curve-key and --allow-controllers",
                            request.endpoint));
        }
        return std::nullopt;
    }
    if (stream.key.empty()) {
        throw WrongUse("--allow-controllers needs --curve-key, the stream's secret key");
    }
    Faults faults;
    stream::CurveServer server;
    faults.of([&] {
        auto own = stream::read_key_pair(stream.key);
        if (!own) {
            throw WrongUse("--curve-key: " + own.error());
        }
        server.own = *own;
    });
    for (const std::string& file : request.controllers) {
        faults.of([&] {
            const auto keys = stream::read_public_keys(file);
            if (!keys) {
                throw WrongUse("--allow-controllers: " + keys.error());
            }
            server.clients.insert(server.clients.end(), keys->begin(), keys->end());
        });
    }
    faults.refuse();
    return server;
}

LiveControl::LiveControl(const ControlRequest& request, const std::optional<stream::CurveServer>& curve,
                         const Scene& requested, const Scene& resolved, stream::SimulationSource& source)
    : control_(requested, resolved, source), server_(request.endpoint, curve, control_) {}

std::vector<stream::EpochOfChange> LiveControl::begin(const Epoch& epoch) {
    std::vector<stream::EpochOfChange> begun = control_.take_epochs(epoch);
    for (const stream::EpochOfChange& one : begun) {
        changes_.push_back(stream::change_json(one.change));
        told_bytes_ += changes_.back().dump().size();
        while (changes_.size() > most_told || told_bytes_ > most_told_bytes) {
            told_bytes_ -= changes_.front().dump().size();
            changes_.erase(0);
            ++left_out_;
        }
    }
    return begun;
}

void LiveControl::add_to(Json& meta) const {
    if (!changes_.empty()) {
        meta["changes"] = changes_;
    }
    if (left_out_ > 0) {
        meta["changes_left_out"] = left_out_;
    }
}

std::string change_text(const stream::SceneChange& change) {
    std::string text = fmt::format("epoch {} from sample {} on:", change.epoch, change.sample);
    const char* separator = " ";
    for (const auto& [key, value] : change.set.items()) {
        if (change.was.is_null() || change.was.value(key, Json(nullptr)) != value) {
            text += fmt::format("{}{} = {}", separator, key, value.dump());
            separator = ", ";
        }
    }
    text += *separator == ' ' ? " nothing changes" : "";
    return text + (change.goes_on ? "" : "; from static equilibrium");
}

}  // namespace hertzline::app
