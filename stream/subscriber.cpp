#include "stream/subscriber.hpp"

#include <algorithm>
#include <cassert>
#include <cerrno>
#include <stdexcept>

#include <fmt/format.h>

#include "stream/endpoint.hpp"

namespace hertzline {

namespace {

constexpr std::size_t max_parts = 8;
constexpr std::chrono::hours longest{24};  // milliseconds::max() would overflow the clock

}  // namespace

std::string_view Message::text(std::size_t i) const noexcept {
    assert(i < parts());
    return text_of(parts_[i + 1]);
}

std::span<const std::byte> Message::bytes(std::size_t i) const noexcept {
    return std::as_bytes(std::span(text(i)));
}

Subscriber::Subscriber(const std::string& endpoint, const SubscriberOptions& options)
    : socket_(context_, zmq::socket_type::sub) {
    if (const auto fault = endpoint_fault(endpoint, EndpointUse::connect)) {
        throw std::runtime_error(*fault);
    }
    const auto heartbeat = static_cast<int>(options.heartbeat.count());
    socket_.set(zmq::sockopt::rcvhwm, options.receive_high_water_mark);
    socket_.set(zmq::sockopt::linger, 0);  // nothing that we send is worth waiting for
    socket_.set(zmq::sockopt::maxmsgsize, options.max_part_bytes);
    socket_.set(zmq::sockopt::heartbeat_ivl, heartbeat);
    socket_.set(zmq::sockopt::heartbeat_timeout, 3 * heartbeat);
    socket_.set(zmq::sockopt::ipv6, is_ipv6(endpoint));
    try {
        socket_.connect(endpoint);
    } catch (const zmq::error_t& error) {
        throw std::runtime_error(fmt::format("endpoint \"{}\": {}", endpoint, error.what()));
    }
}

void Subscriber::subscribe(std::string_view prefix) {
    socket_.set(zmq::sockopt::subscribe, zmq::const_buffer(prefix.data(), prefix.size()));
}

void Subscriber::unsubscribe(std::string_view prefix) {
    socket_.set(zmq::sockopt::unsubscribe, zmq::const_buffer(prefix.data(), prefix.size()));
}

const Message* Subscriber::receive(std::chrono::milliseconds timeout) {
    using Clock = std::chrono::steady_clock;
    const Clock::time_point deadline = Clock::now() + std::min<std::chrono::milliseconds>(timeout, longest);
    while (true) {
        const Received received = receive_parts();
        if (received == Received::message) {
            return &message_;
        }
        if (received == Received::unusable) {
            continue;
        }
        const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now());
        zmq_pollitem_t item{.socket = socket_.handle(), .fd = 0, .events = ZMQ_POLLIN, .revents = 0};
        if (left.count() <= 0 || zmq_poll(&item, 1, static_cast<long>(left.count())) <= 0) {
            return nullptr;
        }
    }
}

Subscriber::Received Subscriber::receive_parts() {
    std::size_t count = 0;
    bool more = true;
    while (more) {
        if (count >= message_.parts_.size() && count < max_parts) {
            message_.parts_.emplace_back();
        }
        // What is beyond the limit is received over the last part: the message must be read to its end.
        zmq::message_t& part = message_.parts_[count < max_parts ? count : max_parts - 1];
        int status = 0;
        do {
            status = zmq_msg_recv(part.handle(), socket_.handle(), ZMQ_DONTWAIT);
        } while (status < 0 && errno == EINTR);  // or the message's rest would pass for the next one
        if (status < 0) {
            return Received::nothing;  // before the first part only: ZeroMQ delivers messages whole
        }
        more = part.more();
        ++count;
    }
    message_.size_ = count;
    return count <= max_parts ? Received::message : Received::unusable;
}

}  // namespace hertzline
