#pragma once
// The connections of a publisher and their limit. ZeroMQ accepts every peer: silent strangers would use up the
// descriptors.

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <unordered_map>

#include <zmq.hpp>

#include "stream/wire/sockets.hpp"

namespace hertzline::stream {

/// Returns the number that distinguishes a connection from a later one with the same descriptor (SO_COOKIE); nothing
/// when it is no socket.
std::optional<std::uint64_t> socket_cookie(int descriptor) noexcept;

/// Ends the connection, unless the descriptor has become another's. ZeroMQ then forgets the peer and its state.
void cut_off(int descriptor, std::optional<std::uint64_t> cookie) noexcept;

/// Returns a number that changes when the peer takes something: with TCP the acknowledged bytes, else the bytes that
/// wait for it.
std::uint64_t taken_by(int descriptor) noexcept;

/// The connections of a socket that is bound. For the thread that uses the socket.
class Connections {
public:
    /// @param socket not bound yet, outlives this @param most how many there may be
    Connections(zmq::context_t& context, zmq::socket_t& socket, std::size_t most);

    /// Takes in new and closed connections. Beyond the limit, connections without a subscription are cut off first,
    /// the oldest before the others; then the newest.
    /// @param has_ended takes the descriptors of closed connections, before a new one has it
    void update(const std::function<void(int)>& has_ended = [](int /*descriptor*/) {});

    /// Whether a connection was cut off because of the limit.
    bool have_been_too_many() const noexcept { return have_been_too_many_; }

    /// Whether there is such a connection.
    bool knows(int descriptor) const noexcept { return connections_.contains(descriptor); }

    /// A message of that connection subscribed to something.
    void note_subscriber(int descriptor) noexcept;
    /// A message of that connection asks for something: it is as a subscriber until it has all its answers, and then as one
    /// that has just come.
    void note_question(int descriptor) noexcept;
    void note_answer(int descriptor) noexcept;

    /// Checks which connections are full, and which of them have taken something since the last check. Call it before
    /// a message is sent, not right after, when the fastest reader is full, too.
    void look_for_slow_ones(std::chrono::steady_clock::time_point now);
    /// Whether the connection was full at the last check and has taken nothing since an earlier one.
    bool takes_nothing(int descriptor, std::chrono::steady_clock::time_point last_check) const noexcept;
    /// Cuts off the full connection that has taken nothing for longest, and others that have taken nothing for half
    /// as long, but for 20 ms at least: on a busy machine a reader has to wait for a processor.
    void cut_off_the_slowest(std::chrono::steady_clock::time_point now);

private:
    struct Connection {
        std::uint64_t number = 0;  // in the order of their coming
        std::optional<std::uint64_t> cookie;
        bool subscribes = false;
        int questions = 0;  // without an answer so far
        bool cut = false;
        std::uint64_t taken = 0;  // last value of taken_by()
        // Has no room for another byte, and has taken nothing since.
        std::optional<std::chrono::steady_clock::time_point> full_since;
    };
    void keep_to_the_limit();

    SocketMonitor monitor_;
    std::size_t most_;
    std::unordered_map<int, Connection> connections_;  // by descriptor
    std::uint64_t came_ = 0;
    bool have_been_too_many_ = false;
};

/// Cuts off a peer that subscribes to one unknown topic after another: counts the useless messages of each connection.
///
/// libzmq keeps every prefix of every peer in a table of its own, without asking: 200 000 of 248 bytes take 1.6 GiB. An XPUB
/// socket has no limit for them (XPUB_MANUAL keeps them as well) and no way to send a peer away. So its connection is shut down
/// under libzmq, which then forgets the peer and all that it kept for it.
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
