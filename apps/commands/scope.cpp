// hertzline scope: listens to a stream as any analyser does, and shows it in a browser.

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <spdlog/spdlog.h>

#include "apps/arguments/curve_arguments.hpp"
#include "apps/arguments/options.hpp"
#include "apps/command.hpp"
#include "apps/console/output.hpp"
#include "apps/console/signals.hpp"
#include "core/scene/text.hpp"
#include "scope/server/scope_session.hpp"
#include "stream/wire/endpoint.hpp"

namespace hertzline::app {

namespace {

constexpr const char* scope_examples =
    "Open the address that it prints in a browser. It ends in a word that others do\n"
    "not know, and only this machine reaches it, unless --http-to-others. Ctrl-C\n"
    "ends it.\n"
    "Examples:\n"
    "  hertzline scope\n"
    "  hertzline scope --connect ipc:///tmp/hertzline --http 127.0.0.1:0\n"
    "  hertzline scope --scope-allow localhost:9000\n"
    "  hertzline scope --record-to /data/bursts";

struct ScopeOptions {
    std::string endpoint = "tcp://127.0.0.1:5573";
    std::string control;
    std::string http = "127.0.0.1:8573";
    std::vector<std::string> allowed;
    std::string folder = ".";
    bool to_others = false;
    CurveClientRequest curve;
    Format format = Format::text;
};

void check_address(const ScopeOptions& options, const scope::PageAddress& address, Faults& faults) {
    if (!address.loopback && !options.to_others) {
        faults.add("--http",
                   "found " + quoted_briefly(options.http) +
                       ", which other machines reach, and HTTP does not encrypt; allowed: an address of "
                       "this machine alone (127.0.0.1, through an SSH tunnel for others), or "
                       "--http-to-others beside it");
    }
}

void check_folder(const std::string& folder, Faults& faults) {
    std::error_code error;
    if (!std::filesystem::is_directory(folder, error)) {
        faults.add("--record-to", "found " + quoted_briefly(folder) + ", allowed: a folder that is there");
    }
}

/// Checks the options. @throws WrongUse that names every fault
std::pair<scope::ScopeTargets, scope::PageAddress> checked(const ScopeOptions& options) {
    Faults faults;
    scope::ScopeTargets targets{
        .stream = options.endpoint, .control = {}, .curve = {}, .recordings = options.folder};
    faults.add("--connect", stream::endpoint_fault(options.endpoint, stream::EndpointUse::connect));
    if (!options.control.empty()) {
        faults.add("--control", stream::endpoint_fault(options.control, stream::EndpointUse::connect));
        targets.control = options.control;
    }
    auto address = faults.value_of("--http", scope::page_address(options.http));
    if (address) {
        check_address(options, *address, faults);
    }
    for (const std::string& host : options.allowed) {
        if (const auto allowed = faults.value_of("--scope-allow", scope::allowed_host(host));
            allowed && address) {
            address->allowed.push_back(*allowed);
        }
    }
    check_folder(options.folder, faults);
    targets.curve = curve_of(options.curve, faults);
    faults.refuse<WrongUse>();
    return {targets, *address};
}

Exit scope(const ScopeOptions& options) {
    auto [targets, address] = checked(options);
    const std::atomic<bool>& stop = stop_asked();
    if (!address.loopback) {
        spdlog::warn(
            "the page is served to other machines without encryption: anyone who reads the traffic can use "
            "it");
    }
    scope::PageServer server(address, scope::new_token());
    scope::ScopeSession session(std::move(targets), server, stop,
                                [](const std::string& text) { spdlog::warn("{}", text); });
    spdlog::info("scope {}", server.url());
    if (address.host == "0.0.0.0" || address.host == "::") {
        spdlog::info("from another machine, put this one's address in place of {}", address.host);
    }
    while (!stop) {
        session.advance();
    }
    const bool saved = session.finish();
    print_summary(session.summary(), options.format);
    return saved ? Exit::done : Exit::failed;
}

}  // namespace

Run scope_command(CLI::App& app) {
    auto options = std::make_shared<ScopeOptions>();
    app.add_option("--connect", options->endpoint, "endpoint of a stream")
        ->type_name("ENDPOINT")
        ->capture_default_str();
    app.add_option("--control", options->control,
                   "endpoint where the stream takes changes (default: none, the knobs only show)")
        ->type_name("ENDPOINT");
    app.add_option("--http", options->http, "where the page is served; port 0: any free one")
        ->type_name("ADDRESS:PORT")
        ->capture_default_str();
    app.add_flag("--http-to-others", options->to_others,
                 "allow an --http address that other machines reach, unencrypted");
    add_repeatable_option(
        app, "--scope-allow", options->allowed,
        "a further host and port under which a browser reaches the page, through a forwarded port or a "
        "proxy; repeatable")
        ->type_name("HOST:PORT");
    app.add_option("--record-to", options->folder, "folder for the recordings that a page asks for")
        ->type_name("FOLDER")
        ->capture_default_str();
    add_curve_options(app, options->curve);
    add_format_option(app, options->format, "print the summary as one JSON object");
    app.footer(scope_examples);
    return [options] { return scope(*options); };
}

}  // namespace hertzline::app
