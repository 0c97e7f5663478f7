#pragma once
// The listening end: connects, subscribes, receives whole messages. For one thread.

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include <zmq.hpp>

#include "stream/wire/security/curve.hpp"
#include "stream/wire/sockets.hpp"

namespace hertzline::stream {

/// Limits and keys of a subscriber.
struct SubscriberOptions {
    /// Messages that wait for us before the publisher's queue for us begins to fill.
    int receive_high_water_mark = 4096;
    /// Larger parts end the connection [bytes].
    std::int64_t max_part_bytes = std::int64_t{1} << 30;
    /// A publisher that has not answered or introduced itself by then is tried again. Otherwise the system would wait
    /// for minutes for a machine that drops our packets, and miss its return.
    std::chrono::milliseconds handshake{5000};
    /// Encrypts, and listens to the owner of this key only; unset: plain.
    std::optional<CurveClient> curve{};
};

/// A publisher was there, but would not or could not talk to us.
struct Refusal {
    std::string reason;
    bool final = false;  ///< ZeroMQ does not try again: nothing will ever arrive
};

/// A received message: the topic and further parts.
class Message {
public:
    std::string_view topic() const noexcept { return parts_[0].to_string_view(); }
    /// Parts after the topic.
    std::size_t parts() const noexcept { return size_ - 1; }
    /// Part i < parts(), as bytes or as text.
    std::span<const std::byte> bytes(std::size_t i) const noexcept;
    std::string_view text(std::size_t i) const noexcept;

private:
    friend class Subscriber;
    static constexpr std::size_t max_parts = 8;
    std::array<zmq::message_t, max_parts> parts_;  // size_ of them are in use
    std::size_t size_ = 0;
};

/// A connection to one publisher, which is restored when it breaks.
class Subscriber {
public:
    /// Connects. A missing publisher shows only in missing messages.
    /// @throws std::runtime_error with the endpoint and its fault
    explicit Subscriber(const std::string& endpoint, const SubscriberOptions& options = {});

    /// Every topic that begins with `prefix` is received from now on.
    void subscribe(std::string_view prefix);
    void unsubscribe(std::string_view prefix);

    /// The next message; it stays valid until the next call. nullptr when none came in time (of at most a
    /// day), or a signal did.
    /// Messages of more parts than any of ours (8) are passed over.
    const Message* receive(std::chrono::milliseconds timeout);

    /// The last connection that failed since this was asked before: in its handshake, or without a message after it. First of all
    /// that the host's name is not known.
    std::optional<Refusal> refusal();

private:
    void set_options(const std::string& endpoint, const SubscriberOptions& options);

    zmq::context_t context_ = new_context();
    zmq::socket_t socket_;
    SocketMonitor connections_;
    bool introduced_ = false;  // the handshake of the present connection is done
    bool heard_ = false;       // since the last one ended
    std::optional<Refusal> unknown_host_;
    Message message_;
};

}  // namespace hertzline::stream
