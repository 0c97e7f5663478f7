// Requests of a browser for the scope's page or socket: the address of --http and, behind a blank, a host of --scope-allow, then method,
// target, Host, Origin and whether it opens a socket, a line each.

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "core/scene/text.hpp"
#include "scope/server/page_rules.hpp"
#include "tests/fuzz/claim.hpp"

namespace hertzline::fuzz {

using namespace scope;

namespace {

constexpr std::size_t longest_message = 500;
constexpr std::string_view token = "0123456789abcdef0123456789abcdef";

std::string_view next_line(std::string_view& rest) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    const std::string_view line = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    return line;
}

void claim_rules(const PageRequest& request, const PageAddress& address) {
    const auto name = admitted(request, address, token);
    if (!name) {
        claim(name.error().status >= 400 && name.error().status < 500, "a refusal is the visitor's fault");
        claim_message(name.error().text, longest_message);
        return;
    }
    claim(request.target.find(token) == 1, "a request without the token sees nothing");
    claim(request.method == "GET" || request.method == "HEAD", "pages can only be read");
    const bool by_proxy = !address.allowed.empty() && address.allowed.front().starts_with("https://");
    claim(!request.opens_a_socket || request.origin == "http://" + std::string(request.host) ||
              (by_proxy && request.origin == "https://" + std::string(request.host)),
          "no page of another origin opens a socket", std::string(request.origin));
    const bool a_name =
        request.host.find_first_not_of("0123456789abcdefABCDEF.:[]") != std::string_view::npos;
    const std::string host = lower_case(request.host);
    const bool allowed = std::ranges::any_of(address.allowed, [&host](const std::string& origin) {
        return origin.find(host) != std::string::npos;
    });
    claim(!a_name || request.host.starts_with("localhost") || allowed,
          "no name that may be pointed here is ours", std::string(request.host));
}

}  // namespace

}  // namespace hertzline::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    namespace fuzz = hertzline::fuzz;
    std::string_view rest(reinterpret_cast<const char*>(data), size);
    std::string_view host = fuzz::next_line(rest);
    const std::string_view first = host.substr(0, host.find(' '));
    host.remove_prefix(std::min(first.size() + 1, host.size()));
    auto address = hertzline::scope::page_address(first);
    if (!address) {
        fuzz::claim_message(address.error(), fuzz::longest_message);
        return 0;
    }
    if (!host.empty()) {
        auto allowed = hertzline::scope::allowed_host(host);
        if (!allowed) {
            fuzz::claim_message(allowed.error(), fuzz::longest_message);
            return 0;
        }
        address->allowed.push_back(*std::move(allowed));
    }
    hertzline::scope::PageRequest request;
    request.method = fuzz::next_line(rest);
    request.target = fuzz::next_line(rest);
    request.host = fuzz::next_line(rest);
    request.origin = fuzz::next_line(rest);
    request.opens_a_socket = !rest.empty();
    fuzz::claim_rules(request, *address);
    return 0;
}
