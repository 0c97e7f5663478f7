#include "stream/wire/security/peer_quota.hpp"

#include "stream/wire/security/connections.hpp"

namespace hertzline::stream {

namespace {

/// Returns an identity that all messages of a connection share, and no other connection has while one of them lives:
/// libzmq's shared properties. A descriptor alone would not do: the next connection gets it.
const void* connection_of(zmq::message_t& message) noexcept {
    return zmq_msg_gets(message.handle(), "Socket-Type");
}

}  // namespace

void PeerQuota::charge(zmq::message_t& message) {
    const int descriptor = zmq_msg_get(message.handle(), ZMQ_SRCFD);
    const void* const properties = connection_of(message);
    if (descriptor < 0 || properties == nullptr) {
        return;  // libzmq's own: it cancels the subscriptions of a peer that left
    }
    Connection& connection = connections_[descriptor];
    if (connection.charged == 0 || connection_of(connection.first) != properties) {
        connection.first.copy(message);
        connection.charged = 0;
        connection.cookie = socket_cookie(descriptor);
    }
    // Messages may be read long after their peer has left: by then the descriptor may be another's.
    if (connection.charged == allowed_) {
        cut_off(descriptor, connection.cookie);
    }
    ++connection.charged;
}

}  // namespace hertzline::stream
