#include "stream/wire/security/peer_quota.hpp"

#include <sys/socket.h>

namespace hertzline::stream {

namespace {

/// The same for all messages of a connection, and no other's as long as one of them lives: libzmq shares its
/// properties among them. A descriptor alone would not do: the next connection gets it.
const void* connection_of(zmq::message_t& message) noexcept {
    return zmq_msg_gets(message.handle(), "Socket-Type");
}

}  // namespace

void PeerQuota::charge(zmq::message_t& message) {
    const int descriptor = zmq_msg_get(message.handle(), ZMQ_SRCFD);
    const void* const properties = connection_of(message);
    if (descriptor < 0 || properties == nullptr) {
        return;  // libzmq's own: it cancels what a peer that left had subscribed to
    }
    Connection& connection = connections_[descriptor];
    if (connection.charged == 0 || connection_of(connection.first) != properties) {
        connection.first.copy(message);
        connection.charged = 0;
    }
    // Once only: later the descriptor may be another's.
    if (connection.charged == allowed_) {
        ::shutdown(descriptor, SHUT_RDWR);
    }
    ++connection.charged;
}

}  // namespace hertzline::stream
