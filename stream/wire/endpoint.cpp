#include "stream/wire/endpoint.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>

#include <arpa/inet.h>
#include <fmt/format.h>
#include <ifaddrs.h>
#include <netdb.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include "core/scene/text.hpp"

namespace hertzline::stream {

namespace {

constexpr std::string_view tcp_scheme = "tcp://";
constexpr std::string_view ipc_scheme = "ipc://";

bool only_of(std::string_view text, std::string_view further) {
    return std::all_of(text.begin(), text.end(), [further](char c) {
        const bool alphanumeric = (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
        return alphanumeric || further.find(c) != std::string_view::npos;
    });
}

bool good_host(std::string_view host, EndpointUse use) {
    if (host == "*") {
        return use == EndpointUse::bind;
    }
    if (host.size() > 2 && host.front() == '[' && host.back() == ']') {
        return only_of(host.substr(1, host.size() - 2), ":.%-_");
    }
    return !host.empty() && host.size() <= 253 && only_of(host, ".-_");
}

bool good_port(std::string_view port, EndpointUse use) {
    if (port == "*" || port == "0") {
        return use == EndpointUse::bind;
    }
    const auto number = parsed_number<unsigned>(port);  // which has no sign
    return number && *number >= 1 && *number <= 65535;
}

/// Returns the text in quotes, with unprintable characters replaced, and not longer than a line.
std::string in_quotes(std::string_view text) {
    return '"' + printable(text) + '"';
}

std::optional<std::string> tcp_fault(std::string_view endpoint, EndpointUse use) {
    const std::string_view address = endpoint.substr(tcp_scheme.size());
    const std::size_t colon = address.rfind(':');
    if (colon == std::string_view::npos) {
        return fmt::format("endpoint {} has no port: write tcp://HOST:PORT", in_quotes(endpoint));
    }
    const std::string_view host = address.substr(0, colon);
    const std::string_view port = address.substr(colon + 1);
    const bool binds = use == EndpointUse::bind;
    if (!good_host(host, use)) {
        return fmt::format("endpoint {}: host {} is not a name, an IPv4 address or [IPv6]{}",
                           in_quotes(endpoint), in_quotes(host), binds ? ", or * for every interface" : "");
    }
    if (!good_port(port, use)) {
        return fmt::format("endpoint {}: port {} is not a number from 1 to 65535{}", in_quotes(endpoint),
                           in_quotes(port), binds ? ", or 0 or * for any free port" : "");
    }
    return std::nullopt;
}

std::optional<std::string> ipc_fault(std::string_view endpoint) {
    const std::string_view path = endpoint.substr(ipc_scheme.size());
    // '@' would be Linux's abstract namespace and '*' a path of ZeroMQ's choice: neither is a
    // file that other users see.
    if (path.empty() || path == "*" || path.front() == '@' || path.back() == '/') {
        return fmt::format("endpoint {}: {} is not the path of a file", in_quotes(endpoint), in_quotes(path));
    }
    // The endpoint is announced, a line that programs read.
    if (std::any_of(path.begin(), path.end(), [](char c) { return (c >= 0 && c < ' ') || c == 0x7F; })) {
        return fmt::format("endpoint {}: control characters in the path", in_quotes(endpoint));
    }
    if (path.size() > max_ipc_path) {
        return fmt::format("endpoint {}: the path has {} bytes, at most {} are allowed", in_quotes(endpoint),
                           path.size(), max_ipc_path);
    }
    return std::nullopt;
}

/// Returns the host of an endpoint tcp://HOST:PORT.
std::string_view host_of(std::string_view endpoint) {
    const std::string_view address = endpoint.substr(tcp_scheme.size());
    return address.substr(0, address.rfind(':'));
}

bool is_loopback(const sockaddr& address) {
    if (address.sa_family == AF_INET) {
        const auto& ipv4 = reinterpret_cast<const sockaddr_in&>(address);
        return ntohl(ipv4.sin_addr.s_addr) >> 24 == IN_LOOPBACKNET;
    }
    return address.sa_family == AF_INET6 &&
           IN6_IS_ADDR_LOOPBACK(&reinterpret_cast<const sockaddr_in6&>(address).sin6_addr) != 0;
}

/// Whether all addresses of the interface are loopback ones; nothing when there is no such interface.
std::optional<bool> local_interface(const std::string& name, int family) {
    ifaddrs* interfaces = nullptr;
    if (::getifaddrs(&interfaces) != 0) {
        return false;
    }
    std::optional<bool> local;
    for (const ifaddrs* each = interfaces; each != nullptr; each = each->ifa_next) {
        if (name == each->ifa_name && each->ifa_addr != nullptr && each->ifa_addr->sa_family == family) {
            local = local.value_or(true) && is_loopback(*each->ifa_addr);
        }
    }
    ::freeifaddrs(interfaces);
    return local;
}

/// Whether the text is a loopback address, read by the function with which ZeroMQ reads it.
bool local_address(const std::string& text, int family) {
    addrinfo wanted{};
    wanted.ai_family = family;
    wanted.ai_flags = AI_NUMERICHOST;
    addrinfo* found = nullptr;
    if (::getaddrinfo(text.c_str(), nullptr, &wanted, &found) != 0) {
        return false;
    }
    const bool local = is_loopback(*found->ai_addr);
    ::freeaddrinfo(found);
    return local;
}

/// Whether a program accepts connections at the path of an existing socket.
bool is_live(std::string_view path) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::memcpy(address.sun_path, path.data(), path.size());
    // Non-blocking: a server that is alive but too busy to accept gives EAGAIN instead of blocking us.
    const int probe = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    if (probe < 0) {
        return true;  // unknown: better not to delete it
    }
    const int status = ::connect(probe, reinterpret_cast<const sockaddr*>(&address), sizeof address);
    const int error = status == 0 ? 0 : errno;
    ::close(probe);
    return error != ECONNREFUSED && error != ENOENT;
}

}  // namespace

std::optional<std::string> endpoint_fault(std::string_view endpoint, EndpointUse use) {
    if (endpoint.starts_with(tcp_scheme)) {
        return tcp_fault(endpoint, use);
    }
    if (endpoint.starts_with(ipc_scheme)) {
        return ipc_fault(endpoint);
    }
    return fmt::format("endpoint {} is neither tcp://HOST:PORT nor ipc://PATH", in_quotes(endpoint));
}

std::optional<std::string> occupied_fault(std::string_view endpoint) {
    if (!endpoint.starts_with(ipc_scheme) || ipc_fault(endpoint)) {
        return std::nullopt;
    }
    const std::string path(endpoint.substr(ipc_scheme.size()));
    struct stat status {};
    if (::lstat(path.c_str(), &status) != 0) {
        return std::nullopt;  // nothing there, or no way there: the bind itself will fail
    }
    if (!S_ISSOCK(status.st_mode)) {
        return fmt::format("endpoint {}: the path is a file that is not a socket", in_quotes(endpoint));
    }
    if (is_live(path)) {
        return fmt::format("endpoint {}: address in use by another program", in_quotes(endpoint));
    }
    return std::nullopt;
}

bool is_ipv6(std::string_view endpoint) noexcept {
    return endpoint.starts_with("tcp://[");
}

tl::expected<bool, std::string> reached_over_ipv6(std::string_view endpoint) {
    if (is_ipv6(endpoint) || !endpoint.starts_with(tcp_scheme)) {
        return is_ipv6(endpoint);
    }
    addrinfo wanted{};
    wanted.ai_socktype = SOCK_STREAM;
    addrinfo* found = nullptr;
    if (const int error = ::getaddrinfo(std::string(host_of(endpoint)).c_str(), nullptr, &wanted, &found)) {
        return tl::unexpected(fmt::format("endpoint {}: the name of its host is not known ({})",
                                          in_quotes(endpoint), ::gai_strerror(error)));
    }
    bool only_ipv6 = true;
    for (const addrinfo* each = found; each != nullptr; each = each->ai_next) {
        only_ipv6 = only_ipv6 && each->ai_family == AF_INET6;
    }
    ::freeaddrinfo(found);
    return only_ipv6;
}

std::string bind_address(std::string_view endpoint) {
    constexpr std::string_view localhost = "tcp://localhost:";
    if (!endpoint.starts_with(localhost)) {
        return std::string(endpoint);
    }
    return "tcp://127.0.0.1:" + std::string(endpoint.substr(localhost.size()));
}

bool is_local(std::string_view endpoint) {
    if (endpoint.starts_with(ipc_scheme)) {
        return true;
    }
    const std::string bound = bind_address(endpoint);
    std::string_view host = host_of(bound);
    const int family = is_ipv6(bound) ? AF_INET6 : AF_INET;
    if (family == AF_INET6) {
        host = host.substr(1, host.size() - 2);
    }
    // An interface of that name comes first, as it does for ZeroMQ.
    return local_interface(std::string(host), family).value_or(local_address(std::string(host), family));
}

}  // namespace hertzline::stream
