#pragma once
// One endpoint that sends topics to subscribers. All of it must be used from one thread: ZeroMQ's
// sockets are not thread-safe, and sending may take hundreds of microseconds, so never the simulating one.
//
// ZeroMQ's send succeeds although frames vanish at a slow subscriber's high-water mark. Only the numbers
// inside the frames show a listener its losses; nothing here can.

#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

#include <zmq.hpp>

#include "stream/wire/security/connections.hpp"
#include "stream/wire/security/curve.hpp"
#include "stream/wire/security/zap.hpp"
#include "stream/wire/sockets.hpp"
#include "stream/wire/subscriptions.hpp"
#include "stream/wire/topics.hpp"

namespace hertzline::stream {

/// Limits and keys of a publisher.
struct PublisherOptions {
    /// Memory that the queues of all slow subscribers together may take [bytes].
    double queue_bytes = 256.0 * 1024 * 1024;
    /// Size of the largest message [bytes].
    double largest_message = 4096;
    /// Connections at a time. At the limit connections without a subscription are closed first.
    int max_clients = 64;
    /// Messages that wait for a slow subscriber before it loses some, in place of queue_length().
    int max_queue_length = 65536;
    /// The time for which send_last() and the destructor together wait for subscribers to take the last messages.
    /// With all the rest it is to stay below the second in which Ctrl-C ends a stream.
    std::chrono::milliseconds linger{600};
    /// A tcp subscriber whose machine has acknowledged nothing for this time is disconnected. An analyser may pause
    /// as long once its own buffers are full.
    std::chrono::milliseconds unread{15000};
    /// A peer that has not introduced itself by then is cut off, because silent connections cost a descriptor each.
    /// Three round trips and a little arithmetic fit many times, however busy the peer's program is.
    std::chrono::milliseconds handshake{5000};
    /// Encrypts, and admits listed clients; unset: plain, for every client that can reach the endpoint.
    std::optional<CurveServer> curve{};
};

/// Returns the number of messages that may wait for one subscriber, at least one. As many of the largest fill half of
/// the memory for all queues; ZeroMQ's own needs for them, for every client, fill a quarter.
int queue_length(const PublisherOptions& options) noexcept;

/// Memory that the queues take at most [bytes].
double most_queued_bytes(const PublisherOptions& options) noexcept;

/// An XPUB socket that is bound to one endpoint.
class Publisher {
public:
    /// Binds.
    /// @param topics all that will ever be sent
    /// @throws std::runtime_error with the endpoint and its fault: its text, the address in
    /// use, no such interface
    explicit Publisher(const std::string& endpoint, std::span<const std::string_view> topics = all_topics,
                       const PublisherOptions& options = {});

    /// The endpoint as bound, with a real port in place of *.
    const std::string& endpoint() const noexcept { return endpoint_; }

    /// Takes in subscriptions and cancellations since the last call, without waiting. Returns the number of
    /// subscriptions to our topics, repeated ones included: each may need the meta message. At most 1000 messages a
    /// call, so that a flood cannot delay the frames. ZeroMQ lets a subscription take effect in any call, send()
    /// included: call this right before a batch of frames.
    std::size_t poll_subscriptions();

    /// Waits until there are some to take in, but no longer than this.
    void wait_for_subscriptions(std::chrono::milliseconds most) noexcept;

    /// Whether the topic has a subscriber, as of the last poll_subscriptions().
    bool wanted(std::string_view topic) const noexcept { return subscriptions_.wanted(topic); }

    /// Whether it has one that takes messages. One that has stopped reading and whose queue is full does not: each
    /// further message to it would vanish.
    bool taken(std::string_view topic) const noexcept { return subscriptions_.taken(topic); }

    /// Sends one message: the topic, then each part (any contiguous range of plain values: std::string_view,
    /// span of float). Never waits. False when ZeroMQ refused it, which no subscriber's behaviour can cause.
    template <class... Parts>
    bool send(std::string_view topic, const Parts&... parts) noexcept {
        const std::array<std::span<const std::byte>, 1 + sizeof...(parts)> message{bytes_of(topic),
                                                                                   bytes_of(parts)...};
        subscriptions_.note_sent(topic);
        return send_parts(socket_, message);
    }

    /// A payload for send_frame(). It is counted for as long as it waits in a queue.
    /// @param write is given that many bytes, aligned for any type, and writes all of them
    /// @throws the exceptions of `write`
    zmq::message_t payload(std::size_t bytes, const std::function<void(void*)>& write);

    /// Sends a message with a payload(), which is handed over, not copied.
    bool send_frame(std::string_view topic, zmq::message_t payload) noexcept {
        subscriptions_.note_sent(topic);
        return send_parts(socket_, std::array{bytes_of(topic)}, std::move(payload));
    }
    bool send_frame(std::string_view topic, std::string_view header, zmq::message_t payload) noexcept {
        subscriptions_.note_sent(topic);
        return send_parts(socket_, std::array{bytes_of(topic), bytes_of(header)}, std::move(payload));
    }

    /// Sends a text, counted as a payload is.
    bool send_text(std::string_view topic, std::string_view text);

    /// Sends the last message of all. A subscriber whose queue is full loses it without a sign, so it is sent again
    /// every 100 ms while the topic has subscribers, for as long as the publisher may linger.
    void send_last(std::string_view topic, std::string_view text);

    Security security() const noexcept { return gate_ ? Security::curve : Security::none; }

    /// Returns the number of clients with an unlisted key. (A wrong server key or none ends the handshake before and
    /// is not counted.)
    std::uint64_t refused_clients() const noexcept { return gate_ ? gate_->refused() : 0; }

    /// Whether more clients have asked to connect than may.
    bool has_had_too_many_clients() const noexcept { return connections_.have_been_too_many(); }
    int max_clients() const noexcept { return options_.max_clients; }

private:
    template <class Part>
    static std::span<const std::byte> bytes_of(const Part& part) noexcept {
        static_assert(!std::is_array_v<Part>, "a literal has a NUL at its end: pass a std::string_view");
        return std::as_bytes(std::span(part));
    }
    void set_options(const std::string& endpoint);
    void update_connections();
    bool take_subscription();
    void look_for_slow_ones();

    PublisherOptions options_;
    std::atomic<std::size_t> queued_{0};  // bytes of payloads that ZeroMQ has; outlives the context
    zmq::context_t context_ = new_context();
    std::optional<ZapHandler> gate_;  // before the socket, which must never be reachable without it
    zmq::socket_t socket_;
    Connections connections_;
    std::chrono::steady_clock::time_point last_look_{};
    std::chrono::steady_clock::time_point last_cut_{};
    Subscriptions subscriptions_;
    PeerQuota quota_{100};  // far more than any client has use for
    std::string endpoint_;
    zmq::message_t incoming_;
};

}  // namespace hertzline::stream
