#pragma once
// Cuts off a peer that subscribes to one unknown topic after another.
//
// libzmq keeps every prefix of every peer in a table of its own, without asking: 200 000 of 248 bytes take 1.6 GiB.
// An XPUB socket has no limit for them (XPUB_MANUAL keeps them as well) and no way to send a peer away. So its
// connection is shut down under libzmq, which then forgets the peer and all that it kept for it.

#include <cstdint>
#include <optional>
#include <unordered_map>

#include <zmq.hpp>

namespace hertzline::stream {

/// Counts the useless messages of each connection.
class PeerQuota {
public:
    /// The number of messages that may be charged to a connection.
    explicit PeerQuota(int allowed) noexcept : allowed_(allowed) {}

    /// Charges the message to the connection that it came by. Beyond the quota the connection is shut down; messages
    /// still on the way then cost other peers nothing.
    void charge(zmq::message_t& message);

private:
    struct Connection {
        zmq::message_t first;  // keeps libzmq's properties of the connection, which identify it
        int charged = 0;
        std::optional<std::uint64_t> cookie;
    };
    int allowed_;
    std::unordered_map<int, Connection> connections_;  // by descriptor, so there are never many
};

}  // namespace hertzline::stream
