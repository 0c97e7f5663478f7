#pragma once
// Events of a socket's connections (zmq_socket_monitor).

#include <cstdint>
#include <optional>

#include <zmq.hpp>

namespace hertzline::stream {

/// A connection's event: ZMQ_EVENT_... and its value, often the descriptor.
struct SocketEvent {
    int kind = 0;
    std::uint32_t value = 0;
};

/// Receives the events of one socket. Destroyed before it.
class SocketMonitor {
public:
    /// @param kinds ZMQ_EVENT_... of interest @throws zmq::error_t
    SocketMonitor(zmq::context_t& context, zmq::socket_t& socket, int kinds);
    ~SocketMonitor();
    SocketMonitor(const SocketMonitor&) = delete;
    SocketMonitor& operator=(const SocketMonitor&) = delete;

    /// The next event, without waiting.
    std::optional<SocketEvent> next();

private:
    zmq::socket_t& socket_;
    zmq::socket_t events_;
    zmq::message_t part_;
};

}  // namespace hertzline::stream
