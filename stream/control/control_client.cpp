#include "stream/control/control_client.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <span>
#include <stdexcept>
#include <string_view>

#include <fmt/format.h>

#include "core/scene/faults.hpp"
#include "core/scene/json.hpp"
#include "stream/control/control_server.hpp"
#include "stream/wire/endpoint.hpp"
#include "stream/wire/sockets.hpp"

namespace hertzline::stream {

namespace {

/// The connection of a controller that waits for its reply.
class Connection {
public:
    explicit Connection(bool encrypted) noexcept : encrypted_(encrypted) {}

    /// Takes an event. @returns why no reply will come; empty: it may come
    std::string take(const SocketEvent& event) {
        const std::string too_many =
            fmt::format("it has as many controllers as it serves ({})", most_controllers);
        switch (event.kind) {
            case ZMQ_EVENT_CONNECTED:
                reached_ = true;
                return {};
            case ZMQ_EVENT_HANDSHAKE_SUCCEEDED:
                introduced_ = true;
                return {};
            case ZMQ_EVENT_HANDSHAKE_FAILED_AUTH:
                return "it refused our key, which is not on its list (--allow-controllers)";
            case ZMQ_EVENT_HANDSHAKE_FAILED_PROTOCOL:
                return event.value == ZMQ_PROTOCOL_ERROR_ZMTP_MECHANISM_MISMATCH
                           ? "either the stream's control or this controller encrypts, but not both"
                           : "it is not the control of a stream";
            default:
                return introduced_
                           ? "it ended the connection before it answered: " + too_many + ", or has ended"
                           : fmt::format("it closed the connection during the handshake: {}, or {}",
                                         encrypted_ ? "--server-key is not its key, it does not encrypt"
                                                    : "it encrypts, it is not the control of a stream",
                                         too_many);
        }
    }

    /// Why no reply has come in time.
    std::string silence() const {
        if (!reached_) {
            return "nothing is there: no stream that was started with --control";
        }
        return introduced_ ? "no reply in time; a change that was asked for may still take effect"
                           : "it does not answer: it may be stopped, or no stream's control";
    }

private:
    bool encrypted_;
    bool reached_ = false;
    bool introduced_ = false;
};

}  // namespace

zmq::socket_t control_socket(zmq::context_t& context, const std::string& endpoint,
                             const std::optional<CurveClient>& curve, std::optional<SocketMonitor>* monitor) {
    throw_if(endpoint_fault(endpoint, EndpointUse::connect));
    zmq::socket_t socket(context, zmq::socket_type::dealer);
    if (curve) {
        encrypt_as_client(socket, *curve);
    }
    constexpr std::int64_t longest_reply = 64 << 20;
    socket.set(zmq::sockopt::linger, 0);
    socket.set(zmq::sockopt::maxmsgsize, longest_reply);
    socket.set(zmq::sockopt::ipv6, reached_over_ipv6(endpoint).value_or(false));
    if (monitor != nullptr) {
        monitor->emplace(context, socket, ZMQ_EVENT_CONNECTED | handshake_events);
    }
    try {
        socket.connect(endpoint);
    } catch (const zmq::error_t& error) {
        throw std::runtime_error(fmt::format("endpoint \"{}\": {}", endpoint, error.what()));
    }
    return socket;
}

Json ask_control(const ControlConnection& connection, const Json& request, const std::atomic<bool>& stop) {
    using Clock = std::chrono::steady_clock;
    if (const auto known = reached_over_ipv6(connection.endpoint); !known) {
        throw std::runtime_error(known.error());
    }
    zmq::context_t context = new_context();
    std::optional<SocketMonitor> monitor;
    zmq::socket_t socket = control_socket(context, connection.endpoint, connection.curve, &monitor);
    const std::string text = ascii_json_text(request);
    if (text.size() > max_request_bytes) {
        throw std::runtime_error(
            fmt::format("the request has {} bytes, allowed: at most {}", text.size(), max_request_bytes));
    }
    const std::array parts{std::as_bytes(std::span(text))};
    send_parts(socket, parts);
    constexpr double day_s = 86400;
    const std::chrono::duration<double> timeout(std::min(connection.timeout_s, day_s));
    const Clock::time_point end = Clock::now() + std::chrono::duration_cast<Clock::duration>(timeout);
    Connection watched(connection.curve.has_value());
    std::string why;
    while (why.empty() && Clock::now() < end && !stop.load(std::memory_order_relaxed)) {
        zmq_pollitem_t item{.socket = socket.handle(), .fd = 0, .events = ZMQ_POLLIN, .revents = 0};
        zmq_poll(&item, 1, nap_ms);
        for (auto event = monitor->next(); event && why.empty(); event = monitor->next()) {
            why = watched.take(*event);
        }
        std::array<zmq::message_t, 1> received;
        if (receive_parts(socket, received) == 0) {
            continue;
        }
        Json reply = json_from_outside(received[0].to_string_view(), connection.endpoint);
        if (!reply.is_object()) {
            throw std::runtime_error(connection.endpoint + ": the reply is no JSON object");
        }
        return reply;
    }
    if (why.empty()) {
        why = stop.load(std::memory_order_relaxed) ? "stopped before a reply came" : watched.silence();
    }
    throw std::runtime_error(connection.endpoint + ": " + why);
}

}  // namespace hertzline::stream
