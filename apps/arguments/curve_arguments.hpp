#pragma once
// --curve-key and its companions: the options that make a stream or a listener encrypt, and their keys.

#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "core/scene/faults.hpp"
#include "stream/wire/security/curve.hpp"

namespace hertzline::app {

/// The endpoints that other machines may reach.
enum class Exposure { encrypted, anything };

/// The encryption options of `stream` and `replay`.
struct CurveServerRequest {
    std::string key;                   // our secret key; empty: no encryption
    std::vector<std::string> clients;  // certificates, or directories of them
    Exposure exposure = Exposure::encrypted;
};

/// The encryption options of `listen`.
struct CurveClientRequest {
    std::string key;     // our secret key; empty: no encryption
    std::string server;  // the publisher's certificate
};

void add_curve_options(CLI::App& app, CurveServerRequest& request);
void add_curve_options(CLI::App& app, CurveClientRequest& request);

/// Adds the fault of an endpoint that other machines reach without keys, unless that was allowed.
void check_exposure(const CurveServerRequest& request, const std::string& endpoint, Faults& faults);

/// Reads the keys of a server; adds the faults of files that hold none. @param option names the clients
stream::CurveServer server_keys(const std::string& key, const char* option,
                                const std::vector<std::string>& clients, Faults& faults);

/// Reads the keys; unset when the options ask for no encryption. Adds every fault: one option without the other, files
/// that are no keys, a secret key that others may read.
std::optional<stream::CurveServer> curve_of(const CurveServerRequest& request, Faults& faults);
std::optional<stream::CurveClient> curve_of(const CurveClientRequest& request, Faults& faults);

}  // namespace hertzline::app
