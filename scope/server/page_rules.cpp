#include "scope/server/page_rules.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <optional>
#include <system_error>
#include <utility>

#include <arpa/inet.h>
#include <fmt/format.h>
#include <sys/random.h>

#include "core/scene/text.hpp"

namespace hertzline::scope {

namespace {

/// How a browser reaches a page.
struct Scheme {
    std::string_view prefix;
    unsigned port;  ///< where the address has none
};
constexpr Scheme http_scheme{"http://", 80};
constexpr Scheme https_scheme{"https://", 443};  // a proxy before the scope decrypts

/// Whether all of the text is an address: inet_pton() reads to the first NUL only.
bool is_address(int family, const std::string& text) {
    in6_addr address{};
    return text.find('\0') == std::string::npos && ::inet_pton(family, text.c_str(), &address) == 1;
}

bool is_ipv4(const std::string& text) {
    return is_address(AF_INET, text);
}

bool is_ipv6(const std::string& text) {
    return is_address(AF_INET6, text);
}

std::optional<unsigned> port_in(std::string_view text) {
    constexpr unsigned largest = 65535;
    const auto port = parsed_number<unsigned>(text);
    return port && *port <= largest ? port : std::nullopt;
}

/// Splits "HOST:PORT"; without a colon after the host the port is empty.
std::pair<std::string_view, std::string_view> host_and_port(std::string_view text) {
    const std::size_t colon = text.rfind(':');
    const std::size_t bracket = text.rfind(']');
    if (colon == std::string_view::npos || (bracket != std::string_view::npos && colon < bracket)) {
        return {text, {}};
    }
    return {text.substr(0, colon), text.substr(colon + 1)};
}

std::string without_brackets(std::string_view host) {
    const bool bracketed = host.size() > 2 && host.front() == '[' && host.back() == ']';
    return std::string(bracketed ? host.substr(1, host.size() - 2) : host);
}

bool is_name(std::string_view text) {
    const auto fits = [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-' || c == '.' || c == '_';
    };
    return !text.empty() && text.size() <= 253 && std::ranges::all_of(text, fits);
}

/// Returns the scheme, host and port of a Host header; nothing where it is none.
std::optional<std::string> origin_of(const Scheme& scheme, std::string_view host_header) {
    const std::string lower = lower_case(host_header);
    const auto [host, port_text] = host_and_port(lower);
    const auto port =
        port_text.empty() && !lower.ends_with(':') ? std::optional(scheme.port) : port_in(port_text);
    const bool good = host.starts_with('[') ? is_ipv6(without_brackets(host)) : is_name(host);
    if (!good || !port || *port == 0) {
        return std::nullopt;
    }
    return fmt::format("{}{}:{}", scheme.prefix, host, *port);
}

/// Whether the user allows this host by this scheme.
bool is_allowed(const Scheme& scheme, std::string_view host_header, const PageAddress& address) {
    const auto origin = origin_of(scheme, host_header);
    return origin && std::ranges::count(address.allowed, *origin) > 0;
}

/// Whether the host is the address of the page itself, which has no encryption.
bool is_own(std::string_view host_header, const PageAddress& address) {
    const auto [host, port_text] = host_and_port(host_header);
    const auto port = port_text.empty() ? std::optional(http_scheme.port) : port_in(port_text);
    if (!port || *port != address.port) {
        return false;
    }
    const std::string name = without_brackets(host);
    if (name == "localhost" || name == address.host) {
        return true;
    }
    // A name can be pointed anywhere by its owner, an address cannot.
    return !address.loopback && (is_ipv4(name) || is_ipv6(name));
}

/// Compares in a time that depends on the length alone.
bool equal(std::string_view a, std::string_view b) {
    if (a.size() != b.size()) {
        return false;
    }
    unsigned difference = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        difference |= static_cast<unsigned char>(a[i]) ^ static_cast<unsigned char>(b[i]);
    }
    return difference == 0;
}

tl::unexpected<PageRefusal> refused(unsigned status, std::string text) {
    return tl::unexpected(PageRefusal{status, std::move(text)});
}

}  // namespace

tl::expected<PageAddress, std::string> page_address(std::string_view text) {
    const auto wrong = [&] {
        return tl::unexpected(
            "found " + quoted_briefly(text) +
            ", allowed: ADDRESS:PORT, as 127.0.0.1:8573, [::1]:8573 or localhost:8573; port 0 "
            "is any free one");
    };
    const auto [host, port_text] = host_and_port(text);
    const auto port = port_in(port_text);
    const std::string name = host == "localhost" ? "127.0.0.1" : without_brackets(host);
    const bool bracketed = host.starts_with('[');
    if (!port || (bracketed ? !is_ipv6(name) : !is_ipv4(name))) {
        return wrong();
    }
    const bool loopback = bracketed ? name == "::1" : name.starts_with("127.");
    return PageAddress{name, static_cast<std::uint16_t>(*port), loopback};
}

tl::expected<std::string, std::string> allowed_host(std::string_view text) {
    const bool encrypted = text.starts_with(https_scheme.prefix);
    const auto origin = encrypted ? origin_of(https_scheme, text.substr(https_scheme.prefix.size()))
                                  : origin_of(http_scheme, text);
    if (!origin) {
        return tl::unexpected("found " + quoted_briefly(text) +
                              ", allowed: HOST:PORT as in the browser's address, as localhost:9000 or "
                              "https://scope.example.org; without a port it is 80, or 443");
    }
    return *origin;
}

std::string host_in_url(const PageAddress& address) {
    return address.host.find(':') == std::string::npos ? address.host : "[" + address.host + "]";
}

tl::expected<std::string, PageRefusal> admitted(const PageRequest& request, const PageAddress& address,
                                                std::string_view token) {
    const bool plain = is_own(request.host, address) || is_allowed(http_scheme, request.host, address);
    const bool encrypted = is_allowed(https_scheme, request.host, address);
    if (!plain && !encrypted) {
        return refused(421,
                       "The scope is not known under this name and port. To reach it through a forwarded "
                       "port or another "
                       "name, start it with --scope-allow HOST:PORT, as in the browser's address.");
    }
    const auto is_from = [&](const Scheme& scheme) {
        return request.origin == std::string(scheme.prefix) + std::string(request.host);
    };
    if (!request.origin.empty() && !(plain && is_from(http_scheme)) &&
        !(encrypted && is_from(https_scheme))) {
        return refused(403, "Pages of another origin are not served.");
    }
    if (request.opens_a_socket && request.origin.empty()) {
        return refused(403, "A WebSocket needs the page's origin.");
    }
    const std::string_view target = request.target;
    if (target.size() < token.size() + 2 || target.front() != '/' ||
        !equal(target.substr(1, token.size()), token) || target[token.size() + 1] != '/') {
        return refused(
            403,
            "Open the address that hertzline scope has printed: it ends in a word that others do not know.");
    }
    if (request.method != "GET" && request.method != "HEAD") {
        return refused(405, "Pages can only be read.");
    }
    return std::string(target.substr(token.size() + 2));
}

std::string new_token() {
    std::array<unsigned char, 16> bits{};
    std::size_t count = 0;
    while (count < bits.size()) {
        const ssize_t more = ::getrandom(bits.data() + count, bits.size() - count, 0);
        if (more < 0 && errno != EINTR) {
            throw std::system_error(errno, std::generic_category(), "random numbers");
        }
        count += more > 0 ? static_cast<std::size_t>(more) : 0;
    }
    return fmt::format("{:02x}", fmt::join(bits, ""));
}

}  // namespace hertzline::scope
