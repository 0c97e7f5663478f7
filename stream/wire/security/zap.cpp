#include "stream/wire/security/zap.hpp"

#include <algorithm>
#include <cstring>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>

#include "stream/wire/sockets.hpp"

namespace hertzline::stream {

namespace {

constexpr const char* endpoint = "inproc://zeromq.zap.01";  // fixed by ZAP
constexpr const char* version = "1.0";

constexpr const char* status_granted = "200";
constexpr const char* status_refused = "400";
constexpr const char* status_not_understood = "500";  // admits no peer either

enum Part : std::size_t { version_part = 0, id_part = 1, mechanism_part = 5, key_part = 6 };

zmq::socket_t bound_socket(zmq::context_t& context) {
    try {
        zmq::socket_t socket(context, zmq::socket_type::rep);
        socket.set(zmq::sockopt::linger, 0);
        socket.bind(endpoint);
        return socket;
    } catch (const zmq::error_t& error) {
        throw std::runtime_error(std::string("cannot look up the keys of clients: ") + error.what());
    }
}

}  // namespace

ZapHandler::ZapHandler(zmq::context_t& context, std::vector<CurveKey> allowed)
    : allowed_(std::move(allowed)), socket_(bound_socket(context)) {
    std::ranges::sort(allowed_);
    thread_ = std::jthread([this](const std::stop_token& stop) { answer_until(stop); });
}

void ZapHandler::answer_until(const std::stop_token& stop) noexcept {
    while (!stop.stop_requested()) {
        zmq_pollitem_t item{.socket = socket_.handle(), .fd = 0, .events = ZMQ_POLLIN, .revents = 0};
        if (zmq_poll(&item, 1, nap_ms) > 0) {
            // A request of more parts is refused for their number.
            if (const std::size_t parts = receive_parts(socket_, request_)) {
                reply(verdict(parts));
            }
        }
    }
}

const char* ZapHandler::verdict(std::size_t parts) noexcept {
    if (parts != request_parts || request_[version_part].to_string_view() != version) {
        return status_not_understood;
    }
    CurveKey key{};
    if (request_[mechanism_part].to_string_view() == "CURVE" && request_[key_part].size() == key.size()) {
        std::memcpy(key.data(), request_[key_part].data(), key.size());
        // In time that depends on the key: it is public, and its sender owns it.
        if (std::ranges::binary_search(allowed_, key)) {
            return status_granted;
        }
    }
    refused_.fetch_add(1, std::memory_order_relaxed);
    return status_refused;
}

/// If a part cannot be sent, ZeroMQ gets no answer and does not admit the peer.
void ZapHandler::reply(std::string_view status) noexcept {
    constexpr std::string_view none;
    const std::array<std::string_view, 6> texts{version, request_[id_part].to_string_view(),
                                                status,  none,   // status text
                                                none,    none};  // user, metadata
    std::array<std::span<const std::byte>, texts.size()> parts;
    std::ranges::transform(texts, parts.begin(),
                           [](std::string_view text) { return std::as_bytes(std::span(text)); });
    send_parts(socket_, parts);
}

}  // namespace hertzline::stream
