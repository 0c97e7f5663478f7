// Requests of a browser for the scope's page or socket: method, target, Host, Origin and whether it opens a socket, a line each; and the
// address of the first line as that of --http.

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

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
    claim(!request.opens_a_socket || request.origin == "http://" + std::string(request.host),
          "no page of another origin opens a socket", std::string(request.origin));
    const bool a_name =
        request.host.find_first_not_of("0123456789abcdefABCDEF.:[]") != std::string_view::npos;
    claim(!a_name || request.host.starts_with("localhost"), "no name that may be pointed here is ours",
          std::string(request.host));
}

}  // namespace

}  // namespace hertzline::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    namespace fuzz = hertzline::fuzz;
    std::string_view rest(reinterpret_cast<const char*>(data), size);
    const auto address = hertzline::scope::page_address(fuzz::next_line(rest));
    if (!address) {
        fuzz::claim_message(address.error(), fuzz::longest_message);
        return 0;
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
