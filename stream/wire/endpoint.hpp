#pragma once
// Endpoints are checked here before ZeroMQ sees them, because it accepts wrong ones: port 99999 becomes
// 34463, -1 becomes 65535, and binding an ipc path deletes whatever lies there, a live server's socket included.

#include <optional>
#include <string>
#include <string_view>

#include <tl/expected.hpp>

namespace hertzline::stream {

enum class EndpointUse { bind, connect };

/// Longest path of an ipc endpoint [bytes]: sun_path of a Unix socket without its final NUL.
inline constexpr std::size_t max_ipc_path = 107;

/// Returns the fault of an endpoint's text, or nullopt. Looks at the text only.
///     tcp://HOST:PORT   HOST a name, an IPv4 address or an [IPv6] one, to bind also * (every interface);
///                       PORT 1 to 65535, to bind also 0 and * (any free one)
///     ipc://PATH        a file name of at most max_ipc_path bytes, without control characters
std::optional<std::string> endpoint_fault(std::string_view endpoint, EndpointUse use);

/// Returns why an ipc endpoint cannot be bound without harm: another program answers there, or the path is no socket.
/// Nothing when the path is free, or holds a dead server's leftover. Any tcp endpoint: nothing. Between this look
/// and the bind another process may still come first: a guard against accidents, not a lock.
std::optional<std::string> occupied_fault(std::string_view endpoint);

/// Whether the endpoint's host is an IPv6 address, for which ZeroMQ needs an option set.
bool is_ipv6(std::string_view endpoint) noexcept;

/// Whether the endpoint is connected to over IPv6, for which ZeroMQ needs the same option: its host is such an address, or
/// a name with no other addresses. The fault: the name is not known at present. Asks the system's name servers.
tl::expected<bool, std::string> reached_over_ipv6(std::string_view endpoint);

/// The endpoint as ZeroMQ binds it: it knows interfaces and addresses there, but not the name localhost.
std::string bind_address(std::string_view endpoint);

/// Whether an endpoint to bind can be reached from this machine only: ipc, localhost, an address in 127.0.0.0/8 or
/// [::1], or the name of an interface that has no other. An unknown address counts as reachable.
bool is_local(std::string_view endpoint);

}  // namespace hertzline::stream
