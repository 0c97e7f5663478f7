#include "stream/wire/subscriber.hpp"

#include <algorithm>
#include <cassert>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "core/scene/faults.hpp"
#include "stream/wire/endpoint.hpp"
#include "stream/wire/sockets.hpp"

namespace hertzline::stream {

namespace {

constexpr std::chrono::hours longest{24};  // milliseconds::max() would overflow the clock

/// Returns the user's message for a monitor's event of a failed handshake.
Refusal refusal_of(int event, std::uint32_t value) {
    if (event == ZMQ_EVENT_HANDSHAKE_FAILED_AUTH) {
        return {"the publisher refused our key: it is not on its list", true};
    }
    if (event == ZMQ_EVENT_HANDSHAKE_FAILED_PROTOCOL && value == ZMQ_PROTOCOL_ERROR_ZMTP_MECHANISM_MISMATCH) {
        return {"either the publisher or the listener encrypts, but not both", true};
    }
    if (event == ZMQ_EVENT_HANDSHAKE_FAILED_PROTOCOL) {
        return {"the peer is not a hertzline publisher", true};
    }
    return {
        "the peer closed the connection during the handshake: only one side encrypts, --server-key is wrong, "
        "or it has as many clients as it serves (--max-clients)",
        false};
}

}  // namespace

std::string_view Message::text(std::size_t i) const noexcept {
    assert(i < parts());
    return parts_[i + 1].to_string_view();
}

std::span<const std::byte> Message::bytes(std::size_t i) const noexcept {
    return std::as_bytes(std::span(text(i)));
}

Subscriber::Subscriber(const std::string& endpoint, const SubscriberOptions& options)
    : socket_(context_, zmq::socket_type::sub), connections_(context_, socket_, handshake_events) {
    throw_if(endpoint_fault(endpoint, EndpointUse::connect));
    if (options.curve) {
        encrypt_as_client(socket_, *options.curve);
    }
    set_options(endpoint, options);
    try {
        socket_.connect(endpoint);
    } catch (const zmq::error_t& error) {
        throw std::runtime_error(fmt::format("endpoint \"{}\": {}", endpoint, error.what()));
    }
}

void Subscriber::set_options(const std::string& endpoint, const SubscriberOptions& options) {
    const auto handshake = static_cast<int>(options.handshake.count());
    socket_.set(zmq::sockopt::rcvhwm, options.receive_high_water_mark);
    socket_.set(zmq::sockopt::linger, 0);  // nothing that we send is worth waiting for
    socket_.set(zmq::sockopt::maxmsgsize, options.max_part_bytes);
    // A publisher whose machine is gone is connected again after a quarter of a minute. No heartbeats: see
    // publisher.cpp.
    socket_.set(zmq::sockopt::tcp_keepalive, 1);
    socket_.set(zmq::sockopt::tcp_keepalive_idle, 5);
    socket_.set(zmq::sockopt::tcp_keepalive_intvl, 5);
    socket_.set(zmq::sockopt::tcp_keepalive_cnt, 2);
    socket_.set(zmq::sockopt::handshake_ivl, handshake);
    socket_.set(zmq::sockopt::connect_timeout, handshake);
    const auto over_ipv6 = reached_over_ipv6(endpoint);
    socket_.set(zmq::sockopt::ipv6, over_ipv6.value_or(false));
    if (!over_ipv6) {
        unknown_host_ = {over_ipv6.error(), false};
    }
}

std::optional<Refusal> Subscriber::refusal() {
    std::optional<Refusal> last = std::exchange(unknown_host_, {});
    while (const auto event = connections_.next()) {
        if (event->kind == ZMQ_EVENT_HANDSHAKE_SUCCEEDED) {
            introduced_ = true;
        } else if (event->kind != ZMQ_EVENT_DISCONNECTED) {
            last = refusal_of(event->kind, event->value);
        } else {
            if (introduced_ && !heard_) {
                last = {
                    "the publisher ended the connection before it sent anything: it has as many clients as "
                    "it serves (--max-clients), or is ending",
                    false};
            }
            introduced_ = heard_ = false;
        }
    }
    return last;
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
        message_.size_ = receive_parts(socket_, message_.parts_);
        if (message_.size_ > message_.parts_.size()) {
            continue;
        }
        if (message_.size_ > 0) {
            heard_ = true;
            return &message_;
        }
        const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now());
        zmq_pollitem_t item{.socket = socket_.handle(), .fd = 0, .events = ZMQ_POLLIN, .revents = 0};
        if (left.count() <= 0 || zmq_poll(&item, 1, static_cast<long>(left.count())) <= 0) {
            return nullptr;
        }
    }
}

}  // namespace hertzline::stream
