#include "stream/wire/security/connections.hpp"

#include <algorithm>
#include <vector>

#include <poll.h>
#include <sys/socket.h>

namespace hertzline::stream {

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

Connections::Connections(zmq::context_t& context, zmq::socket_t& socket, std::size_t most)
    : monitor_(context, socket, ZMQ_EVENT_ACCEPTED | ZMQ_EVENT_DISCONNECTED), most_(most) {}

void Connections::update() {
    while (const auto event = monitor_.next()) {
        const auto descriptor = static_cast<int>(event->value);
        connections_.erase(descriptor);
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

void Connections::look_for_slow_ones(std::chrono::steady_clock::time_point now) {
    for (auto& [descriptor, connection] : connections_) {
        pollfd state{.fd = descriptor, .events = POLLOUT, .revents = 0};
        const bool full = ::poll(&state, 1, 0) == 0;
        if (!full) {
            connection.full_since.reset();
        } else if (!connection.full_since) {
            connection.full_since = now;
        }
    }
}

void Connections::forget_slow_ones() noexcept {
    for (auto& each : connections_) {
        each.second.full_since.reset();
    }
}

void Connections::cut_off_the_slowest(std::chrono::steady_clock::time_point now) {
    auto longest = now;
    for (const auto& each : connections_) {
        longest = std::min(longest, each.second.cut ? now : each.second.full_since.value_or(now));
    }
    for (auto& [descriptor, connection] : connections_) {
        if (!connection.cut && connection.full_since && 2 * (now - *connection.full_since) >= now - longest) {
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

}  // namespace hertzline::stream
