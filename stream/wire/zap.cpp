#include "stream/wire/zap.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

namespace hertzline::stream {

namespace {

constexpr const char* endpoint = "inproc://zeromq.zap.01";  // as ZAP fixes it
constexpr const char* version = "1.0";
constexpr long nap_ms = 100;  // between looks at the stop flag

constexpr const char* status_granted = "200";
constexpr const char* status_refused = "400";
constexpr const char* status_not_understood = "500";  // lets nobody in either

enum Part : std::size_t { version_part = 0, id_part = 1, mechanism_part = 5, key_part = 6 };

std::string_view text_of(const zmq::message_t& part) noexcept {
    return {static_cast<const char*>(part.data()), part.size()};
}

}  // namespace

ZapHandler::ZapHandler(zmq::context_t& context, std::vector<CurveKey> allowed)
    : allowed_(std::move(allowed)), socket_(context, zmq::socket_type::rep) {
    std::ranges::sort(allowed_);
    socket_.set(zmq::sockopt::linger, 0);
    socket_.bind(endpoint);
    thread_ = std::jthread([this](const std::stop_token& stop) { answer_until(stop); });
}

void ZapHandler::answer_until(const std::stop_token& stop) noexcept {
    while (!stop.stop_requested()) {
        zmq_pollitem_t item{.socket = socket_.handle(), .fd = 0, .events = ZMQ_POLLIN, .revents = 0};
        if (zmq_poll(&item, 1, nap_ms) > 0) {
            if (const std::size_t parts = receive_request()) {
                reply(verdict(parts));
            }
        }
    }
}

/// Reads a request to its end. @returns how many parts it had; 0: none came.
std::size_t ZapHandler::receive_request() noexcept {
    std::size_t parts = 0;
    bool more = true;
    while (more) {
        // What is beyond the last part goes over it: such a request is refused for their number.
        zmq::message_t& part = request_[std::min(parts, request_parts - 1)];
        int status = 0;
        do {
            status = zmq_msg_recv(part.handle(), socket_.handle(), ZMQ_DONTWAIT);
        } while (status < 0 && errno == EINTR);
        if (status < 0) {
            return 0;
        }
        more = part.more();
        ++parts;
    }
    return parts;
}

const char* ZapHandler::verdict(std::size_t parts) noexcept {
    if (parts != request_parts || text_of(request_[version_part]) != version) {
        return status_not_understood;
    }
    CurveKey key{};
    if (text_of(request_[mechanism_part]) == "CURVE" && request_[key_part].size() == key.size()) {
        std::memcpy(key.data(), request_[key_part].data(), key.size());
        // In time that depends on the key: it is a public one, and who sends it owns it.
        if (std::ranges::binary_search(allowed_, key)) {
            return status_granted;
        }
    }
    refused_.fetch_add(1, std::memory_order_relaxed);
    return status_refused;
}

/// Should a part not be sent, ZeroMQ hears no answer and the peer stays outside.
void ZapHandler::reply(std::string_view status) noexcept {
    const std::array<std::string_view, 6> parts{version, text_of(request_[id_part]),
                                                status,  "",   // status text
                                                "",      ""};  // user, metadata
    for (std::size_t i = 0; i < parts.size(); ++i) {
        const int flags = ZMQ_DONTWAIT | (i + 1 < parts.size() ? ZMQ_SNDMORE : 0);
        while (zmq_send(socket_.handle(), parts[i].data(), parts[i].size(), flags) < 0) {
            if (errno != EINTR) {
                return;
            }
        }
    }
}

}  // namespace hertzline::stream
