#include "stream/control/control_server.hpp"

#include <algorithm>
#include <array>
#include <exception>
#include <memory>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <pthread.h>

#include "core/scene/faults.hpp"
#include "core/scene/json.hpp"
#include "stream/wire/endpoint.hpp"
#include "stream/wire/sockets.hpp"

namespace hertzline::stream {

namespace {

constexpr long short_nap_ms = 2;  // while a change is on its way
constexpr int linger_ms = 200;    // for the last answers
constexpr int at_a_time = 16;     // requests, before the change on its way is looked at again
constexpr int at_the_end = 1000;  // the same, the last time

/// Identity of the sender, an empty part if it is a REQ, the request.
constexpr std::size_t most_parts = 3;

std::span<const std::byte> bytes_of(const std::string& text) noexcept {
    return std::as_bytes(std::span(text));
}

void set_options(zmq::socket_t& socket, const std::string& endpoint) {
    socket.set(zmq::sockopt::linger, linger_ms);
    socket.set(zmq::sockopt::maxmsgsize, static_cast<std::int64_t>(max_request_bytes));
    socket.set(zmq::sockopt::rcvhwm, 16);  // for each sender, whose further ones wait over there
    socket.set(zmq::sockopt::rcvbuf, 64 * 1024);
    socket.set(zmq::sockopt::sndhwm,
               128);  // all waiting requests, answered at once, and those that come meanwhile
    socket.set(zmq::sockopt::handshake_ivl, 5000);
    socket.set(zmq::sockopt::backlog, 16);
    socket.set(zmq::sockopt::tcp_maxrt, 15000);
    socket.set(zmq::sockopt::tcp_keepalive, 1);
    socket.set(zmq::sockopt::tcp_keepalive_idle, 60);
    socket.set(zmq::sockopt::ipv6, is_ipv6(endpoint));
}

/// @throws std::runtime_error where nothing can be bound
const std::string& bindable(const std::string& endpoint) {
    throw_if(endpoint_fault(endpoint, EndpointUse::bind));
    throw_if(occupied_fault(endpoint));
    return endpoint;
}

Json not_understood(const std::string& found) {
    return faults_json({{"", found, "one JSON object in one part"}});
}

}  // namespace

ControlServer::ControlServer(const std::string& endpoint, const std::optional<CurveServer>& curve,
                             SceneControl& control)
    : control_(control),
      endpoint_(bindable(endpoint)),
      socket_(context_, zmq::socket_type::router),
      connections_(context_, socket_, most_controllers) {
    if (curve) {
        zap_.emplace(context_, curve->clients);  // before the socket binds
        encrypt_as_server(socket_, curve->own);
    }
    set_options(socket_, endpoint);
    try {
        socket_.bind(bind_address(endpoint));
    } catch (const zmq::error_t& error) {
        throw std::runtime_error(fmt::format("control endpoint \"{}\": {}", endpoint, error.what()));
    }
    endpoint_ = socket_.get(zmq::sockopt::last_endpoint);
    thread_ = std::thread([this] {
        pthread_setname_np(pthread_self(), control_thread_name);
        serve();
    });
}

ControlServer::~ControlServer() {
    stopping_.store(true, std::memory_order_release);
    thread_.join();
}

void ControlServer::serve() noexcept {
    bool stopping = false;
    while (!stopping) {
        stopping = stopping_.load(std::memory_order_acquire);  // then it looks once more
        zmq_pollitem_t item{.socket = socket_.handle(), .fd = 0, .events = ZMQ_POLLIN, .revents = 0};
        zmq_poll(&item, 1, stopping ? 0 : control_.busy() ? short_nap_ms : nap_ms);
        try {
            connections_.update();
            receive_some(stopping ? at_the_end : at_a_time);
            if (const std::int64_t end = ended_at_.load(std::memory_order_acquire); end >= 0 || stopping) {
                control_.end(end);
            } else {
                control_.tick();
            }
        } catch (const std::exception&) {  // too little memory for a request: it is not answered
        }
    }
}

void ControlServer::receive_some(int most) {
    for (int i = 0; i < most && receive_one(); ++i) {
    }
}

/// False when there was none.
bool ControlServer::receive_one() {
    std::array<zmq::message_t, most_parts> parts;
    const std::size_t count = receive_parts(socket_, parts);
    if (count == 0) {
        return false;
    }
    const int descriptor = zmq_msg_get(parts[std::min(count, most_parts) - 1].handle(), ZMQ_SRCFD);
    connections_.note_question(descriptor);
    const bool empty_part = count == 3 && parts[1].empty();
    std::vector<std::string> envelope{std::string(parts[0].to_string_view())};
    if (count >= 3 && parts[1].empty()) {
        envelope.emplace_back();
    }
    const auto reply = [this, descriptor, cookie = socket_cookie(descriptor),
                        envelope = std::move(envelope)](const Json& json) {
        const std::string text = ascii_json_text(json);
        std::vector<std::span<const std::byte>> out;
        for (const std::string& part : envelope) {
            out.push_back(bytes_of(part));
        }
        out.push_back(bytes_of(text));
        send_parts(socket_, out);  // lost when the sender has gone or takes nothing
        if (socket_cookie(descriptor) == cookie) {
            connections_.note_answer(descriptor);
        }
    };
    if (count != 2 && !empty_part) {
        reply(not_understood(fmt::format("{} parts", count - 1)));
        return true;
    }
    Json request;
    try {
        request = json_from_outside(parts[count - 1].to_string_view(), "the request");
    } catch (const std::runtime_error& error) {
        reply(not_understood(error.what()));
        return true;
    }
    control_.take(request, reply);
    return true;
}

}  // namespace hertzline::stream
