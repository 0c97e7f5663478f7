#pragma once
// Cuts off a peer that subscribes to one thing after another that nobody sends.
//
// libzmq keeps every prefix of every peer in a table of its own, before anybody is asked: 200 000 of 248
// bytes take 1.6 GiB. An XPUB socket has no limit for them (XPUB_MANUAL keeps them as well) and no way to
// send a peer away. So its connection is shut down under libzmq, which then forgets the peer and all that it
// kept for it.

#include <cstdint>
#include <optional>
#include <unordered_map>

#include <zmq.hpp>

namespace hertzline::stream {

/// Counts, for each connection, the messages that nobody has use for.
class PeerQuota {
public:
    /// How many of its messages may be charged to a connection.
    explicit PeerQuota(int allowed) noexcept : allowed_(allowed) {}

    /// Charges the message to the connection that it came by. Beyond the quota the connection is shut down;
    /// what is still on its way from there then costs nobody else anything.
    void charge(zmq::message_t& message);

private:
    struct Connection {
        zmq::message_t first;  // holds on to what libzmq knows of the connection, by which it is recognised
        int charged = 0;
        std::optional<std::uint64_t> cookie;
    };
    int allowed_;
    std::unordered_map<int, Connection> connections_;  // by descriptor, so there are never many
};

}  // namespace hertzline::stream
