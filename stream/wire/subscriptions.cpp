#include "stream/wire/subscriptions.hpp"

#include <algorithm>
#include <cassert>
#include <stdexcept>

#include <fmt/format.h>

namespace hertzline::stream {

Subscriptions::Subscriptions(std::span<const std::string_view> topics) {
    topics_.reserve(topics.size());
    for (const std::string_view topic : topics) {
        if (topic.empty() || topic.size() > 63) {  // one bit per length from 0 to 63
            throw std::invalid_argument(fmt::format("topic \"{}\" has not 1 to 63 characters", topic));
        }
        topics_.push_back({.name = std::string(topic)});
    }
}

Subscriptions::Change Subscriptions::apply(int peer, std::span<const std::byte> message) {
    if (message.empty() || std::to_integer<unsigned>(message[0]) > 1) {
        return Change::malformed;
    }
    const bool subscribes = message[0] == std::byte{1};
    const std::string_view prefix(reinterpret_cast<const char*>(message.data()) + 1, message.size() - 1);
    if (std::ranges::none_of(topics_, [&](const Topic& topic) { return topic.name.starts_with(prefix); })) {
        return Change::foreign;
    }
    Peer& from = peers_[peer];
    from.prefixes.resize(topics_.size());
    const std::uint64_t bit = std::uint64_t{1} << prefix.size();
    for (std::size_t i = 0; i < topics_.size(); ++i) {
        if (topics_[i].name.starts_with(prefix)) {
            set_prefixes(from, i, subscribes ? from.prefixes[i] | bit : from.prefixes[i] & ~bit);
        }
    }
    set_takes(from, true);
    from.sent_before = sent_to(from);
    return subscribes ? Change::subscribed : Change::unsubscribed;
}

void Subscriptions::forget(int peer) noexcept {
    if (const auto found = peers_.find(peer); found != peers_.end()) {
        for (std::size_t i = 0; i < topics_.size(); ++i) {
            set_prefixes(found->second, i, 0);
        }
        peers_.erase(found);
    }
}

bool Subscriptions::wanted(std::string_view topic) const noexcept {
    const Topic* const found = find(topic);
    return found != nullptr && found->subscribers > 0;
}

bool Subscriptions::taken(std::string_view topic) const noexcept {
    const Topic* const found = find(topic);
    return found != nullptr && found->takers > 0;
}

void Subscriptions::note_sent(std::string_view topic) noexcept {
    if (const auto found = std::ranges::find(topics_, topic, &Topic::name); found != topics_.end()) {
        ++found->sent;
    }
}

void Subscriptions::judge(const std::function<bool(int peer)>& takes_nothing, std::uint64_t queue_length) {
    for (auto& [number, peer] : peers_) {
        const std::uint64_t sent = sent_to(peer);
        if (!takes_nothing(number)) {
            set_takes(peer, true);
            peer.sent_before = sent;
        } else if (sent - peer.sent_before >= queue_length) {
            set_takes(peer, false);
        }
    }
}

const Subscriptions::Topic* Subscriptions::find(std::string_view topic) const noexcept {
    const auto found = std::ranges::find(topics_, topic, &Topic::name);
    assert(found != topics_.end() && "a topic that was not announced");
    return found != topics_.end() ? &*found : nullptr;
}

/// Returns the messages so far of all topics that the peer subscribes to.
std::uint64_t Subscriptions::sent_to(const Peer& peer) const noexcept {
    std::uint64_t sent = 0;
    for (std::size_t i = 0; i < topics_.size(); ++i) {
        sent += peer.prefixes[i] != 0 ? topics_[i].sent : 0;
    }
    return sent;
}

void Subscriptions::set_prefixes(Peer& peer, std::size_t topic, std::uint64_t prefixes) noexcept {
    const int more = (prefixes != 0 ? 1 : 0) - (peer.prefixes[topic] != 0 ? 1 : 0);
    topics_[topic].subscribers += more;
    topics_[topic].takers += peer.takes ? more : 0;
    peer.prefixes[topic] = prefixes;
}

void Subscriptions::set_takes(Peer& peer, bool takes) noexcept {
    const int more = (takes ? 1 : 0) - (peer.takes ? 1 : 0);
    for (std::size_t i = 0; i < topics_.size(); ++i) {
        topics_[i].takers += peer.prefixes[i] != 0 ? more : 0;
    }
    peer.takes = takes;
}

}  // namespace hertzline::stream
