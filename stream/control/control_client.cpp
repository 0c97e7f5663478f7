#include "stream/control/control_client.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <span>
#include <stdexcept>
#include <string_view>

#include <fmt/format.h>

#include "core/scene/json.hpp"
#include "stream/wire/endpoint.hpp"
#include "stream/wire/sockets.hpp"

namespace hertzline::stream {

zmq::socket_t control_socket(zmq::context_t& context, const std::string& endpoint,
                             const std::optional<CurveClient>& curve) {
    if (const auto fault = endpoint_fault(endpoint, EndpointUse::connect)) {
        throw std::runtime_error(*fault);
    }
    zmq::socket_t socket(context, zmq::socket_type::dealer);
    if (curve) {
        encrypt_as_client(socket, *curve);
    }
    constexpr std::int64_t longest_reply = 16 << 20;
    socket.set(zmq::sockopt::linger, 0);
    socket.set(zmq::sockopt::maxmsgsize, longest_reply);
    socket.set(zmq::sockopt::ipv6, reached_over_ipv6(endpoint).value_or(false));
    try {
        socket.connect(endpoint);
    } catch (const zmq::error_t& error) {
        throw std::runtime_error(fmt::format("endpoint \"{}\": {}", endpoint, error.what()));
    }
    return socket;
}

Json ask_control(const ControlConnection& connection, const Json& request, const std::atomic<bool>& stop) {
    using Clock = std::chrono::steady_clock;
    constexpr long nap_ms = 50;
    if (const auto known = reached_over_ipv6(connection.endpoint); !known) {
        throw std::runtime_error(known.error());
    }
    zmq::context_t context = new_context();
    zmq::socket_t socket = control_socket(context, connection.endpoint, connection.curve);
    const std::string text = request.dump(-1, ' ', true, Json::error_handler_t::replace);
    const std::array parts{std::as_bytes(std::span(text))};
    send_parts(socket, parts);
    constexpr double day_s = 86400;
    const std::chrono::duration<double> timeout(std::min(connection.timeout_s, day_s));
    const Clock::time_point end = Clock::now() + std::chrono::duration_cast<Clock::duration>(timeout);
    while (Clock::now() < end && !stop.load(std::memory_order_relaxed)) {
        zmq_pollitem_t item{.socket = socket.handle(), .fd = 0, .events = ZMQ_POLLIN, .revents = 0};
        zmq_poll(&item, 1, nap_ms);
        std::array<zmq::message_t, 1> received;
        if (receive_parts(socket, received) == 0) {
            continue;
        }
        Json reply = json_from_outside({static_cast<const char*>(received[0].data()), received[0].size()});
        if (!reply.is_object()) {
            throw std::runtime_error(connection.endpoint + ": the reply is no JSON object");
        }
        return reply;
    }
    throw std::runtime_error(fmt::format(
        "no reply from {}: no stream that was started with --control is there, it does not know our "
        "key, or the change waits for a burst that begins later",
        connection.endpoint));
}

}  // namespace hertzline::stream
