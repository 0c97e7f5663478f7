#include "apps/arguments/curve_arguments.hpp"

#include <utility>

#include <fmt/format.h>

#include "apps/arguments/options.hpp"
#include "apps/command.hpp"
#include "stream/wire/endpoint.hpp"
#include "stream/wire/security/certificate.hpp"

namespace hertzline::app {

namespace {

/// Returns the value, or adds a line of faults.
template <class T>
T value_or_fault(tl::expected<T, std::string> read, const char* option, std::string& faults) {
    if (read) {
        return *std::move(read);
    }
    faults += (faults.empty() ? "" : "\n") + std::string(option) + ": " + read.error();
    return T{};
}

void refuse(const std::string& faults) {
    if (!faults.empty()) {
        throw WrongUse(faults);
    }
}

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

void refuse_exposure(const CurveServerRequest& request, const std::string& endpoint) {
    const bool has_keys = !request.key.empty() || !request.clients.empty();
    if (!has_keys && !stream::is_local(endpoint) && request.exposure == Exposure::encrypted) {
        throw WrongUse(fmt::format(
            "--bind: {} can be reached from other machines, where anyone could listen; give "
            "--curve-key and --allow-clients (hertzline keys makes the keys), or --insecure to allow it",
            endpoint));
    }
}

std::optional<stream::CurveServer> curve_of(const CurveServerRequest& request) {
    if (request.key.empty() && request.clients.empty()) {
        return std::nullopt;
    }
    if (request.clients.empty()) {
        throw WrongUse("--curve-key needs --allow-clients, the public keys of clients that may subscribe");
    }
    if (request.key.empty()) {
        throw WrongUse("--allow-clients needs --curve-key, the stream's secret key");
    }
    std::string faults;
    stream::CurveServer server{
        .own = value_or_fault(stream::read_key_pair(request.key), "--curve-key", faults), .clients = {}};
    for (const std::string& clients : request.clients) {
        const auto keys = value_or_fault(stream::read_public_keys(clients), "--allow-clients", faults);
        server.clients.insert(server.clients.end(), keys.begin(), keys.end());
    }
    refuse(faults);
    return server;
}

std::optional<stream::CurveClient> curve_of(const CurveClientRequest& request) {
    if (request.key.empty() && request.server.empty()) {
        return std::nullopt;
    }
    if (request.server.empty()) {
        throw WrongUse("--curve-key needs --server-key, the stream's public key");
    }
    if (request.key.empty()) {
        throw WrongUse("--server-key needs --curve-key, the listener's secret key");
    }
    std::string faults;
    stream::CurveClient client{
        .own = value_or_fault(stream::read_key_pair(request.key), "--curve-key", faults),
        .server = value_or_fault(stream::read_public_key(request.server), "--server-key", faults)};
    refuse(faults);
    return client;
}

}  // namespace hertzline::app
