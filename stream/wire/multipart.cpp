#include "stream/wire/multipart.hpp"

#include <algorithm>
#include <cerrno>

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

}  // namespace hertzline::stream
