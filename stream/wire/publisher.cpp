#include "stream/wire/publisher.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <memory>
#include <new>
#include <stdexcept>
#include <thread>
#include <tuple>

#include <fmt/format.h>

#include "core/scene/faults.hpp"
#include "stream/wire/endpoint.hpp"

namespace hertzline::stream {

namespace {

std::string bind_failure(const std::string& endpoint, const zmq::error_t& error) {
    switch (error.num()) {
        case EADDRINUSE:
            return fmt::format("endpoint \"{}\": address in use by another program", endpoint);
        case ENODEV:
        case EADDRNOTAVAIL:
            return fmt::format(
                "endpoint \"{}\": this machine has no such address (to bind, the host is one of its "
                "addresses or interfaces, such as 127.0.0.1, or *)",
                endpoint);
        default:
            return fmt::format("endpoint \"{}\": {}", endpoint, error.what());
    }
}

/// Returns the memory of a message of that many bytes: header, topic and the allocator's overhead.
double bytes_with_all(double message) noexcept {
    return 1024 + 1.25 * message;
}

/// Stands in front of a payload.
struct alignas(std::max_align_t) Buffer {
    std::atomic<std::atomic<std::size_t>*> queued;  ///< set when the payload is written
    std::size_t bytes;
};

/// Called by ZeroMQ, in any thread, when the last subscriber has been sent it.
void give_back(void* /*data*/, void* hint) {
    auto* const buffer = static_cast<Buffer*>(hint);
    buffer->queued.load(std::memory_order_acquire)->fetch_sub(buffer->bytes, std::memory_order_relaxed);
    std::free(buffer);
}

}  // namespace

int queue_length(const PublisherOptions& options) noexcept {
    constexpr double in_a_pipe = 3 * 64;  // for the three parts of a message
    const double by_size = options.queue_bytes / 2 / bytes_with_all(options.largest_message);
    const double by_number = options.queue_bytes / 4 / (options.max_clients * in_a_pipe);
    return static_cast<int>(
        std::clamp(std::min(by_size, by_number), 1.0, static_cast<double>(options.max_queue_length)));
}

double most_queued_bytes(const PublisherOptions& options) noexcept {
    // Beside the queues a message is on its way to each.
    return options.queue_bytes + options.max_clients * bytes_with_all(options.largest_message);
}

Publisher::Publisher(const std::string& endpoint, std::span<const std::string_view> topics,
                     const PublisherOptions& options)
    : options_(options),
      socket_(context_, zmq::socket_type::xpub),
      connections_(context_, socket_, static_cast<std::size_t>(options.max_clients)),
      subscriptions_(topics) {
    throw_if(endpoint_fault(endpoint, EndpointUse::bind));
    throw_if(occupied_fault(endpoint));
    if (options.curve) {
        require_curve();
        gate_.emplace(context_, options.curve->clients);
        encrypt_as_server(socket_, options.curve->own);
    }
    set_options(endpoint);
    try {
        socket_.bind(bind_address(endpoint));
    } catch (const zmq::error_t& error) {
        throw std::runtime_error(bind_failure(endpoint, error));
    }
    endpoint_ = socket_.get(zmq::sockopt::last_endpoint);
}

void Publisher::set_options(const std::string& endpoint) {
    socket_.set(zmq::sockopt::sndhwm, queue_length(options_));
    socket_.set(zmq::sockopt::linger, static_cast<int>(options_.linger.count()));
    // Reports every subscriber, not only the first one of a topic: each has to be sent the meta message. And every
    // cancellation, not only the last one.
    socket_.set(zmq::sockopt::xpub_verboser, true);
    // Bounds incoming messages: a peer that subscribes to endless prefixes would fill our memory. The handshake of
    // CURVE counts, too: its longest command has 257 bytes and the peer's metadata.
    socket_.set(zmq::sockopt::maxmsgsize, std::int64_t{options_.curve ? 1024 : 256});
    // A flood of them waits at the peer that sends it. A receiving call takes in all messages that have arrived or
    // arrive meanwhile: with a longer queue it would not return before the flood ends.
    socket_.set(zmq::sockopt::rcvhwm, 1);
    socket_.set(zmq::sockopt::rcvbuf, 16 * 1024);
    socket_.set(zmq::sockopt::handshake_ivl, static_cast<int>(options_.handshake.count()));
    // Connections that wait to be taken in: a laboratory's worth of analysers that all come back at once.
    socket_.set(zmq::sockopt::backlog, 128);
    // The system detects a frozen peer. ZeroMQ's heartbeats would, too, but (4.3.4) end the whole
    // program when one is due on a connection that broke while its subscriptions still waited to be read.
    socket_.set(zmq::sockopt::tcp_maxrt, static_cast<int>(options_.unread.count()));
    // The same for a peer without a subscription.
    socket_.set(zmq::sockopt::tcp_keepalive, 1);
    socket_.set(zmq::sockopt::tcp_keepalive_idle, 60);
    socket_.set(zmq::sockopt::tcp_keepalive_intvl, 10);
    socket_.set(zmq::sockopt::tcp_keepalive_cnt, 3);
    socket_.set(zmq::sockopt::ipv6, is_ipv6(endpoint));
}

std::size_t Publisher::poll_subscriptions() {
    constexpr int max_per_call = 1000;
    std::size_t subscribed = 0;
    update_connections();
    for (int i = 0; i < max_per_call; ++i) {
        if (zmq_msg_recv(incoming_.handle(), socket_.handle(), ZMQ_DONTWAIT) < 0) {
            break;  // nothing more, or a signal came: the rest is taken in by the next call
        }
        subscribed += take_subscription() ? 1 : 0;
    }
    look_for_slow_ones();
    return subscribed;
}

void Publisher::wait_for_subscriptions(std::chrono::milliseconds most) noexcept {
    zmq_pollitem_t item{.socket = socket_.handle(), .fd = 0, .events = ZMQ_POLLIN, .revents = 0};
    zmq_poll(&item, 1, static_cast<long>(most.count()));  // or until a signal comes
}

void Publisher::update_connections() {
    connections_.update([this](int descriptor) { subscriptions_.forget(descriptor); });
}

/// Takes the incoming message. @returns whether it subscribes to one of our topics
bool Publisher::take_subscription() {
    const int descriptor = zmq_msg_get(incoming_.handle(), ZMQ_SRCFD);
    if (descriptor < 0) {
        return false;  // libzmq's own: it cancels the subscriptions of a peer that left
    }
    update_connections();  // its connection may be a new one, with the descriptor of one that has ended
    if (!connections_.knows(descriptor)) {
        return false;
    }
    const auto* data = static_cast<const std::byte*>(incoming_.data());
    switch (subscriptions_.apply(descriptor, {data, incoming_.size()})) {
        case Subscriptions::Change::subscribed:
            connections_.note_subscriber(descriptor);
            return true;
        case Subscriptions::Change::unsubscribed:
            return false;
        case Subscriptions::Change::foreign:
        case Subscriptions::Change::malformed:
            quota_.charge(incoming_);
            return false;
    }
    return false;
}

/// Finds subscribers that take nothing, and disconnects some of them when the queues take too much memory. ZeroMQ does not
/// report whose queue a message waits in, but a connection that takes nothing is behind.
void Publisher::look_for_slow_ones() {
    constexpr std::chrono::milliseconds period{20};  // a cut takes effect within it, too
    const auto queued = static_cast<double>(queued_.load(std::memory_order_relaxed));
    const auto now = std::chrono::steady_clock::now();
    if (queued < options_.queue_bytes / 4 && now - last_look_ < period) {
        return;
    }
    last_look_ = now;
    connections_.look_for_slow_ones(now);
    subscriptions_.judge([&](int descriptor) { return connections_.takes_nothing(descriptor, now); },
                         static_cast<std::uint64_t>(queue_length(options_)));
    if (queued > options_.queue_bytes / 4 * 3 && now - last_cut_ > period) {
        connections_.cut_off_the_slowest(now);
        last_cut_ = now;
    }
}

zmq::message_t Publisher::payload(std::size_t bytes, const std::function<void(void*)>& write) {
    const auto whole = static_cast<std::size_t>(bytes_with_all(static_cast<double>(bytes)));
    std::unique_ptr<void, decltype(&std::free)> memory(std::malloc(sizeof(Buffer) + bytes), std::free);
    if (memory == nullptr) {
        throw std::bad_alloc();
    }
    auto* const buffer = new (memory.get()) Buffer{nullptr, whole};
    write(buffer + 1);
    queued_.fetch_add(whole, std::memory_order_relaxed);
    buffer->queued.store(&queued_, std::memory_order_release);
    zmq::message_t message(buffer + 1, bytes, give_back, buffer);
    std::ignore = memory.release();
    return message;
}

bool Publisher::send_text(std::string_view topic, std::string_view text) {
    return send_frame(topic, payload(text.size(), [text](void* bytes) {
                          std::ranges::copy(text, static_cast<char*>(bytes));
                      }));
}

void Publisher::send_last(std::string_view topic, std::string_view text) {
    using Clock = std::chrono::steady_clock;
    constexpr std::chrono::milliseconds period{100};
    constexpr std::chrono::milliseconds nap{5};  // a subscriber that has it leaves, and then the wait ends
    const Clock::time_point end = Clock::now() + options_.linger;
    Clock::time_point next = Clock::now();
    do {
        if (Clock::now() >= next) {
            send_text(topic, text);
            next += period;
        }
        std::this_thread::sleep_for(nap);
        poll_subscriptions();
    } while (wanted(topic) && Clock::now() + period < end);
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - Clock::now());
    socket_.set(zmq::sockopt::linger, static_cast<int>(std::max(left, std::chrono::milliseconds(0)).count()));
}

}  // namespace hertzline::stream
