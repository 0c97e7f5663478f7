// hertzline set and hertzline get: change the scene of a running stream, and look at it.

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "apps/arguments/curve_arguments.hpp"
#include "apps/arguments/options.hpp"
#include "apps/command.hpp"
#include "apps/console/output.hpp"
#include "apps/console/signals.hpp"
#include "core/scene/text.hpp"
#include "stream/control/control_client.hpp"
#include "stream/wire/endpoint.hpp"

namespace hertzline::app {

namespace {

constexpr const char* set_examples =
    "The stream has to be started with --control. A change takes effect at the next burst's start, or sooner "
    "if "
    "that is more than a second away; at once where bursts do not repeat. KEY=null removes an optional "
    "value, as numerics.accuracy=null before numerics.step_s is given. A list is given in brackets, "
    "KEY=[A,B], or by its entries, "
    "KEY[1]=A. Keys of [drive] (all but its material), "
    "numerics.step_s and "
    "numerics.accuracy keep the motion; all others restart from static equilibrium.\n"
    "Examples:\n"
    "  hertzline set drive.amplitude_m=2e-6\n"
    "  hertzline set chain.preload_n=0.2 chain.damping_kg_per_s=0.3\n"
    "  hertzline set --undo";

/// Of a stream's warnings and faults.
constexpr std::size_t longest_message = 4096;

constexpr const char* get_examples =
    "Examples:\n"
    "  hertzline get\n"
    "  hertzline get drive.amplitude_m chain.preload_n --json";

struct ControlOptions {
    std::string endpoint = stream::usual_control_endpoint;
    CurveClientRequest curve;
    double timeout_s = 10;
    std::vector<std::string> words;  ///< KEY=VALUE, or KEY
    bool undo = false;
    bool force = false;
    Format format = Format::text;
};

void add_connection_options(CLI::App& app, ControlOptions& arguments) {
    app.add_option("--connect", arguments.endpoint, "where the stream is controlled")
        ->type_name("ENDPOINT")
        ->capture_default_str();
    add_curve_options(app, arguments.curve);
    app.add_option("--timeout", arguments.timeout_s, "give up when there is no reply for S seconds")
        ->type_name("S")
        ->capture_default_str();
    add_format_option(app, arguments.format, "print the reply as one JSON object");
}

stream::ControlConnection checked(const ControlOptions& arguments) {
    Faults faults;
    stream::ControlConnection connection{
        .endpoint = arguments.endpoint, .curve = {}, .timeout_s = arguments.timeout_s};
    faults.add("--connect", stream::endpoint_fault(arguments.endpoint, stream::EndpointUse::connect));
    faults.add("--timeout", positive_fault(arguments.timeout_s));
    connection.curve = curve_of(arguments.curve, faults);
    faults.refuse<WrongUse>();
    return connection;
}

/// Returns a number, null, or a text.
Json value_of(const std::string& text) {
    if (const auto number = parsed_number<double>(text); number && std::isfinite(*number)) {
        return *number;
    }
    const Json json = Json::parse(text, nullptr, /*allow_exceptions=*/false);
    return json.is_string() || json.is_null() ? json : Json(text);
}

Json request_of(const ControlOptions& arguments) {
    if (arguments.undo != arguments.words.empty()) {
        throw WrongUse(arguments.undo ? "found both KEY=VALUE and --undo, allowed: one of them"
                                      : "KEY=VALUE or --undo is missing: give one of them");
    }
    if (arguments.undo) {
        return {{"undo", true}};
    }
    Json set = Json::object();
    for (const std::string& word : arguments.words) {
        const std::size_t equals = word.find('=');
        if (equals == std::string::npos || equals == 0) {
            throw WrongUse(
                fmt::format("found {}, allowed: KEY=VALUE, as drive.amplitude_m=2e-6", quoted_briefly(word)));
        }
        if (!is_utf8(word)) {
            throw WrongUse(fmt::format("found {}, allowed: UTF-8", quoted_briefly(word)));
        }
        set[word.substr(0, equals)] = value_of(word.substr(equals + 1));
    }
    Json request{{"set", set}};
    if (arguments.force) {
        request["force"] = true;
    }
    return request;
}

/// Sends the request and reports faults. @returns whether there are none
bool ask(const ControlOptions& arguments, const Json& request, Json& reply) {
    const stream::ControlConnection connection = checked(arguments);
    reply = stream::ask_control(connection, request, stop_asked());
    if (!reply.contains("faults") || !reply["faults"].is_array()) {
        return true;
    }
    for (const Json& fault : reply["faults"]) {
        const auto message = fault.is_object() ? fault.value("message", Json("refused")) : Json("refused");
        spdlog::error("{}", printable(message.is_string() ? message.get<std::string>() : message.dump(),
                                      longest_message));
    }
    return false;
}

Exit set(const ControlOptions& arguments) {
    const Json request = request_of(arguments);
    Json reply;
    if (!ask(arguments, request, reply)) {
        return Exit::wrong_use;
    }
    if (arguments.format == Format::text && reply.contains("warnings")) {
        for (const Json& warning : reply["warnings"]) {
            spdlog::warn("{}", printable(warning.is_string() ? warning.get<std::string>() : warning.dump(),
                                         longest_message));
        }
        reply.erase("warnings");
    }
    print_summary(reply, arguments.format);
    return Exit::done;
}

Exit get(const ControlOptions& arguments) {
    Json reply;
    if (!ask(arguments, {{"get", arguments.words}}, reply)) {
        return Exit::wrong_use;
    }
    if (arguments.format == Format::json) {
        print_summary(reply, Format::json);
        return Exit::done;
    }
    Json flat = Json::object();
    const Json values = reply.value("values", Json::object());
    for (const auto& [key, entry] : values.items()) {
        Json value = entry.is_object() ? entry.value("value", Json(nullptr)) : Json(nullptr);
        constexpr std::size_t most_shown = 64;
        if (value.is_array() && value.size() > most_shown) {  // --json has them all
            value = fmt::format("{} entries", value.size());
        }
        flat[printable(key)] = std::move(value);
    }
    flat["epoch"] = reply.value("epoch", Json(nullptr));
    flat["scene_hash"] = reply.value("scene_hash", Json(nullptr));
    print_summary(flat, Format::text);
    return Exit::done;
}

}  // namespace

Run set_command(CLI::App& app) {
    auto arguments = std::make_shared<ControlOptions>();
    app.add_option("KEY=VALUE", arguments->words, "keys of the scene and their new values")->type_name("");
    app.add_flag("--undo", arguments->undo, "take the last change back instead");
    app.add_flag("--force", arguments->force,
                 "change it even if the stream would then all but stop (a real-time factor below 0.01)");
    add_connection_options(app, *arguments);
    app.footer(set_examples);
    return [arguments] { return set(*arguments); };
}

Run get_command(CLI::App& app) {
    auto arguments = std::make_shared<ControlOptions>();
    app.add_option("KEY", arguments->words, "keys of the scene (default: all)")->type_name("");
    add_connection_options(app, *arguments);
    app.footer(get_examples);
    return [arguments] { return get(*arguments); };
}

}  // namespace hertzline::app
