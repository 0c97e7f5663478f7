#pragma once
// A controller: asks a running stream, and waits for its reply.

#include <atomic>
#include <optional>
#include <string>

#include <zmq.hpp>

#include "core/scene/json.hpp"
#include "stream/wire/security/curve.hpp"
#include "stream/wire/sockets.hpp"

namespace hertzline::stream {

/// The default endpoint of control, on this machine.
inline constexpr const char* usual_control_endpoint = "tcp://127.0.0.1:5574";

/// Connects a socket of a controller. @param monitor made of its connections before, if it is given
/// @throws std::runtime_error that names the endpoint
zmq::socket_t control_socket(zmq::context_t& context, const std::string& endpoint,
                             const std::optional<CurveClient>& curve,
                             std::optional<SocketMonitor>* monitor = nullptr);

/// A way to a stream that is controlled.
struct ControlConnection {
    std::string endpoint = usual_control_endpoint;
    std::optional<CurveClient> curve{};
    double timeout_s = 10;  ///< for the reply; at most a day counts
};

/// Sends the request and returns the reply, an object. @param stop gives up when it becomes true
/// @throws std::runtime_error that names the endpoint and the reason: nothing is there, it refuses us, or does not answer in time
Json ask_control(const ControlConnection& connection, const Json& request, const std::atomic<bool>& stop);

}  // namespace hertzline::stream
