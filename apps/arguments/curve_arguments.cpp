#include "apps/arguments/curve_arguments.hpp"

#include <fmt/format.h>

#include "apps/arguments/options.hpp"
#include "stream/wire/endpoint.hpp"
#include "stream/wire/security/certificate.hpp"

namespace hertzline::app {

namespace {

void add_key_option(CLI::App& app, std::string& key) {
    app.add_option("--curve-key", key,
                   "encrypt with this secret key, NAME.key_secret (made by hertzline keys)")
        ->check(missing_name)
        ->type_name("FILE");
}

}  // namespace

void add_curve_options(CLI::App& app, CurveServerRequest& request) {
    add_key_option(app, request.key);
    add_repeatable_option(
        app, "--allow-clients", request.clients,
        "with --curve-key: public key of a client that may subscribe, NAME.key, or a folder of them")
        ->check(missing_name)
        ->type_name("FILE|FOLDER");
    app.add_flag_callback(
        "--insecure", [&request] { request.exposure = Exposure::anything; },
        "let other machines connect without encryption");
}

void add_curve_options(CLI::App& app, CurveClientRequest& request) {
    add_key_option(app, request.key);
    app.add_option("--server-key", request.server, "with --curve-key: public key of the stream, NAME.key")
        ->check(missing_name)
        ->type_name("FILE");
}

void check_exposure(const CurveServerRequest& request, const std::string& endpoint, Faults& faults) {
    const bool has_keys = !request.key.empty() || !request.clients.empty();
    if (!has_keys && !stream::is_local(endpoint) && request.exposure == Exposure::encrypted) {
        faults.add("--bind",
                   fmt::format("{} can be reached from other machines, where anyone could listen; give "
                               "--curve-key and --allow-clients (hertzline keys makes the keys), or "
                               "--insecure to allow it",
                               endpoint));
    }
}

stream::CurveServer server_keys(const std::string& key, const char* option,
                                const std::vector<std::string>& clients, Faults& faults) {
    stream::CurveServer server;
    server.own = faults.value_of("--curve-key", stream::read_key_pair(key)).value_or(stream::KeyPair());
    for (const std::string& files : clients) {
        if (const auto keys = faults.value_of(option, stream::read_public_keys(files))) {
            server.clients.insert(server.clients.end(), keys->begin(), keys->end());
        }
    }
    return server;
}

std::optional<stream::CurveServer> curve_of(const CurveServerRequest& request, Faults& faults) {
    if (request.key.empty() && request.clients.empty()) {
        return std::nullopt;
    }
    if (request.clients.empty()) {
        faults.add("--curve-key needs --allow-clients, the public keys of clients that may subscribe");
        return std::nullopt;
    }
    if (request.key.empty()) {
        faults.add("--allow-clients needs --curve-key, the stream's secret key");
        return std::nullopt;
    }
    return server_keys(request.key, "--allow-clients", request.clients, faults);
}

std::optional<stream::CurveClient> curve_of(const CurveClientRequest& request, Faults& faults) {
    return stream::read_client_keys(request.key, request.server, "--curve-key", "--server-key", faults);
}

}  // namespace hertzline::app
