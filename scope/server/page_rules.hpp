#pragma once
// The rules of access to the page, which every request has to meet.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <tl/expected.hpp>

namespace hertzline::scope {

/// Where the page is served.
struct PageAddress {
    std::string host;  ///< an address as numbers, IPv6 without brackets
    std::uint16_t port = 0;
    bool loopback = true;  ///< only this machine reaches it
    /// Further hosts under which browsers reach it, through a forwarded port or a proxy: as allowed_host() returns them.
    std::vector<std::string> allowed{};
};

/// Reads "127.0.0.1:8573", "[::1]:8573" or "localhost:8573"; port 0 is any free one. The error is a sentence.
tl::expected<PageAddress, std::string> page_address(std::string_view text);

/// Reads "localhost:9000", "scope.example.org" (port 80) or "[::1]:9000" as a browser's Host header has it, or "https://HOST" of a
/// proxy that decrypts. Returns it with scheme and port, in lower case: "http://localhost:9000". The error is a sentence.
tl::expected<std::string, std::string> allowed_host(std::string_view text);

/// Returns the host as it stands in a URL: IPv6 in brackets.
std::string host_in_url(const PageAddress& address);

/// Fields of a request; empty: left out.
struct PageRequest {
    std::string_view method;
    std::string_view target;
    std::string_view host;
    std::string_view origin;
    bool opens_a_socket = false;  ///< asks for a WebSocket
};

/// The reason why a request is refused.
struct PageRefusal {
    unsigned status = 403;
    std::string text;
};

/// Checks a request. @returns the name that follows the token in its target, or the refusal
///
/// - Host is an address of this server or allowed, not a name that another name server may point here (DNS rebinding).
/// - A WebSocket's Origin is this page, not a foreign page in the same browser.
/// - The target begins with the token, which only the user who started the scope has.
tl::expected<std::string, PageRefusal> admitted(const PageRequest& request, const PageAddress& address,
                                                std::string_view token);

/// Returns 128 random bits as 32 hexadecimal digits. @throws std::system_error
std::string new_token();

}  // namespace hertzline::scope
