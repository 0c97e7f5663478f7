#pragma once
// ZeroMQ's sockets: messages of several parts, sent and received whole, and the events of connections. No call waits, and a
// signal does not tear a message.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include <zmq.hpp>

namespace hertzline::stream {

/// The longest wait for a message, before a thread looks whether it is to stop.
inline constexpr long nap_ms = 50;

/// Makes a context. @throws std::runtime_error when this process may not have the threads and descriptors of its sockets, for want
/// of which ZeroMQ ends the program
zmq::context_t new_context();

/// Sends the parts as one message. False when ZeroMQ refused one of them: then no subscriber gets the message.
bool send_parts(zmq::socket_t& socket, std::span<const std::span<const std::byte>> parts) noexcept;

/// Sends the parts and `last` as one message. `last` is handed over to ZeroMQ, not copied.
bool send_parts(zmq::socket_t& socket, std::span<const std::span<const std::byte>> parts,
                zmq::message_t last) noexcept;

/// Receives the next message. Parts that `parts` has no room for are read over its last one.
/// @returns the number of the message's parts, also when it had more than there is room for; 0 when no message came
std::size_t receive_parts(zmq::socket_t& socket, std::span<zmq::message_t> parts) noexcept;

/// A connection's event: ZMQ_EVENT_... and its value, often the descriptor.
struct SocketEvent {
    int kind = 0;
    std::uint32_t value = 0;
};

/// The events that show whether a connection lasts.
inline constexpr int handshake_events = ZMQ_EVENT_HANDSHAKE_SUCCEEDED | ZMQ_EVENT_HANDSHAKE_FAILED_NO_DETAIL |
                                        ZMQ_EVENT_HANDSHAKE_FAILED_PROTOCOL |
                                        ZMQ_EVENT_HANDSHAKE_FAILED_AUTH | ZMQ_EVENT_DISCONNECTED;

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
