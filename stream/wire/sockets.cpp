#include "stream/wire/sockets.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <stdexcept>

#include "core/scene/faults.hpp"
#include "measures/resources.hpp"
#include "stream/threads.hpp"

namespace hertzline::stream {

namespace {

/// Calls until no signal interrupts. To give up in the midst of a message would make its rest the next one.
template <class Call>
int uninterrupted(Call call) noexcept {
    int status = 0;
    do {
        status = call();
    } while (status < 0 && errno == EINTR);
    return status;
}

bool send_part(zmq::socket_t& socket, std::span<const std::byte> part, int flags) noexcept {
    return uninterrupted([&] {
               return zmq_send(socket.handle(), part.data(), part.size(), ZMQ_DONTWAIT | flags);
           }) >= 0;
}

}  // namespace

zmq::context_t new_context() {
    constexpr double address_bytes = 64 << 20;  // for three threads
    constexpr std::uint64_t descriptors = 24;
    throw_if(measures::limit_shortage("a ZeroMQ socket", address_bytes, descriptors));
    zmq::context_t context;
    const ShortSlices inherited;  // by ZeroMQ's threads, which begin with the first socket
    const zmq::socket_t first(context, zmq::socket_type::pair);
    return context;
}

bool send_parts(zmq::socket_t& socket, std::span<const std::span<const std::byte>> parts) noexcept {
    for (std::size_t i = 0; i < parts.size(); ++i) {
        if (!send_part(socket, parts[i], i + 1 < parts.size() ? ZMQ_SNDMORE : 0)) {
            return false;
        }
    }
    return true;
}

bool send_parts(zmq::socket_t& socket, std::span<const std::span<const std::byte>> parts,
                zmq::message_t last) noexcept {
    for (const std::span<const std::byte> part : parts) {
        if (!send_part(socket, part, ZMQ_SNDMORE)) {
            return false;
        }
    }
    return uninterrupted([&] { return zmq_msg_send(last.handle(), socket.handle(), ZMQ_DONTWAIT); }) >= 0;
}

std::size_t receive_parts(zmq::socket_t& socket, std::span<zmq::message_t> parts) noexcept {
    std::size_t count = 0;
    bool more = true;
    while (more) {
        zmq::message_t& part = parts[std::min(count, parts.size() - 1)];
        if (uninterrupted([&] { return zmq_msg_recv(part.handle(), socket.handle(), ZMQ_DONTWAIT); }) < 0) {
            return 0;  // before the first part only: ZeroMQ delivers messages whole
        }
        more = part.more();
        ++count;
    }
    return count;
}

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
