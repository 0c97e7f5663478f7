#include "stream/wire/socket_monitor.hpp"

#include <cstring>

namespace hertzline::stream {

SocketMonitor::SocketMonitor(zmq::context_t& context, zmq::socket_t& socket, int kinds)
    : socket_(socket), events_(context, zmq::socket_type::pair) {
    constexpr const char* address = "inproc://events";
    events_.set(zmq::sockopt::linger, 0);
    events_.set(zmq::sockopt::rcvhwm, 0);  // at a limit ZeroMQ's own thread would wait for us to read
    if (zmq_socket_monitor(socket.handle(), address, kinds) != 0) {
        throw zmq::error_t();
    }
    events_.connect(address);
}

SocketMonitor::~SocketMonitor() {
    // Else ZeroMQ's own thread would wait for a reader that is gone.
    zmq_socket_monitor(socket_.handle(), nullptr, 0);
}

std::optional<SocketEvent> SocketMonitor::next() {
    while (zmq_msg_recv(part_.handle(), events_.handle(), ZMQ_DONTWAIT) >= 0) {
        // A first part with the event's number and value, a second one with the address.
        std::uint16_t kind = 0;
        std::uint32_t value = 0;
        if (part_.more() && part_.size() == sizeof kind + sizeof value) {
            std::memcpy(&kind, part_.data(), sizeof kind);
            std::memcpy(&value, static_cast<const char*>(part_.data()) + sizeof kind, sizeof value);
            return SocketEvent{kind, value};
        }
    }
    return std::nullopt;
}

}  // namespace hertzline::stream
