#include "stream/wire/security/connections.hpp"

#include <algorithm>
#include <vector>

#include <linux/sockios.h>
#include <linux/tcp.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/socket.h>

namespace hertzline::stream {

using namespace std::chrono_literals;

std::optional<std::uint64_t> socket_cookie(int descriptor) noexcept {
    std::uint64_t cookie = 0;
    socklen_t size = sizeof cookie;
    const bool known = ::getsockopt(descriptor, SOL_SOCKET, SO_COOKIE, &cookie, &size) == 0;
    return known ? std::optional(cookie) : std::nullopt;
}

void cut_off(int descriptor, std::optional<std::uint64_t> cookie) noexcept {
    if (cookie && cookie == socket_cookie(descriptor)) {
        ::shutdown(descriptor, SHUT_RDWR);
    }
}

std::uint64_t taken_by(int descriptor) noexcept {
    tcp_info info{};
    socklen_t size = sizeof info;
    if (::getsockopt(descriptor, IPPROTO_TCP, TCP_INFO, &info, &size) == 0) {
        return info.tcpi_bytes_acked;
    }
    int waiting = 0;
    return ::ioctl(descriptor, SIOCOUTQ, &waiting) == 0 ? static_cast<std::uint64_t>(waiting) : 0;
}

Connections::Connections(zmq::context_t& context, zmq::socket_t& socket, std::size_t most)
    : monitor_(context, socket, ZMQ_EVENT_ACCEPTED | ZMQ_EVENT_DISCONNECTED), most_(most) {}

void Connections::update(const std::function<void(int)>& has_ended) {
    while (const auto event = monitor_.next()) {
        const auto descriptor = static_cast<int>(event->value);
        if (connections_.erase(descriptor) > 0) {
            has_ended(descriptor);
        }
        if (event->kind == ZMQ_EVENT_ACCEPTED) {
            connections_[descriptor] = {
                .number = came_++, .cookie = socket_cookie(descriptor), .full_since = {}};
        }
    }
    if (connections_.size() > most_) {
        keep_to_the_limit();
    }
}

void Connections::note_subscriber(int descriptor) noexcept {
    if (const auto found = connections_.find(descriptor); found != connections_.end()) {
        found->second.subscribes = true;
    }
}

void Connections::note_question(int descriptor) noexcept {
    if (const auto found = connections_.find(descriptor); found != connections_.end()) {
        found->second.subscribes = true;
        ++found->second.questions;
    }
}

void Connections::note_answer(int descriptor) noexcept {
    if (const auto found = connections_.find(descriptor);
        found != connections_.end() && --found->second.questions <= 0) {
        found->second.subscribes = false;
        found->second.number = came_++;
    }
}

void Connections::look_for_slow_ones(std::chrono::steady_clock::time_point now) {
    for (auto& [descriptor, connection] : connections_) {
        pollfd state{.fd = descriptor, .events = POLLOUT, .revents = 0};
        const bool full = ::poll(&state, 1, 0) == 0;
        const std::uint64_t taken = taken_by(descriptor);
        if (!full) {
            connection.full_since.reset();
        } else if (!connection.full_since || taken != connection.taken) {
            connection.full_since = now;
        }
        connection.taken = taken;
    }
}

bool Connections::takes_nothing(int descriptor,
                                std::chrono::steady_clock::time_point last_check) const noexcept {
    const auto found = connections_.find(descriptor);
    return found != connections_.end() && found->second.full_since && *found->second.full_since < last_check;
}

void Connections::cut_off_the_slowest(std::chrono::steady_clock::time_point now) {
    const auto idle = [now](const Connection& connection) {
        return connection.cut || !connection.full_since ? -1ns : now - *connection.full_since;
    };
    const auto slowest =
        std::ranges::max_element(connections_, {}, [&](const auto& each) { return idle(each.second); });
    if (slowest == connections_.end() || idle(slowest->second) < 0ns) {
        return;
    }
    const auto longest = idle(slowest->second);
    for (auto& [descriptor, connection] : connections_) {
        const bool as_slow = idle(connection) >= 20ms && 2 * idle(connection) >= longest;
        if (as_slow || descriptor == slowest->first) {
            cut_off(descriptor, connection.cookie);
            connection.cut = true;
        }
    }
}

void Connections::keep_to_the_limit() {
    std::vector<std::pair<const int, Connection>*> those;
    for (auto& each : connections_) {
        if (!each.second.cut) {
            those.push_back(&each);
        }
    }
    std::ranges::sort(those, [](const auto* a, const auto* b) {
        const Connection& one = a->second;
        const Connection& other = b->second;
        if (one.subscribes != other.subscribes) {
            return other.subscribes;
        }
        return one.subscribes ? one.number > other.number : one.number < other.number;
    });
    for (std::size_t i = 0; i + most_ < those.size(); ++i) {
        cut_off(those[i]->first, those[i]->second.cookie);
        those[i]->second.cut = true;
        have_been_too_many_ = true;
    }
}

namespace {

/// Returns an identity that all messages of a connection share, and no other connection has while one of them lives:
/// libzmq's shared properties. A descriptor alone would not do: the next connection gets it.
const void* connection_of(zmq::message_t& message) noexcept {
    return zmq_msg_gets(message.handle(), "Socket-Type");
}

}  // namespace

void PeerQuota::charge(zmq::message_t& message) {
    const int descriptor = zmq_msg_get(message.handle(), ZMQ_SRCFD);
    const void* const properties = connection_of(message);
    if (descriptor < 0 || properties == nullptr) {
        return;  // libzmq's own: it cancels the subscriptions of a peer that left
    }
    Connection& connection = connections_[descriptor];
    if (connection.charged == 0 || connection_of(connection.first) != properties) {
        connection.first.copy(message);
        connection.charged = 0;
        connection.cookie = socket_cookie(descriptor);
    }
    // Messages may be read long after their peer has left: by then the descriptor may be another's.
    if (connection.charged == allowed_) {
        cut_off(descriptor, connection.cookie);
    }
    ++connection.charged;
}

}  // namespace hertzline::stream
