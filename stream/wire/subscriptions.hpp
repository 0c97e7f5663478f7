#pragma once
// The topics with subscribers, from the (un)subscription messages that reach a publisher.
//
// A peer subscribes to prefixes, as many as it likes: a set of them would grow with whatever it sends. Here a prefix is kept
// as one bit of each topic that begins with it, so memory is bounded by peers and topics, and no peer can crowd out
// another's subscription.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace hertzline::stream {

/// The topics that have a subscriber.
class Subscriptions {
public:
    /// The kind of a message.
    enum class Change {
        subscribed,    ///< a prefix of some topic, new or known already
        unsubscribed,  ///< no longer such a prefix
        foreign,       ///< a prefix that no topic begins with
        malformed,     ///< no (un)subscription at all
    };

    /// Topics of 1 to 63 characters. @throws std::invalid_argument for others.
    explicit Subscriptions(std::span<const std::string_view> topics);

    /// Takes a message of an XPUB socket: byte 1 (subscribe) or 0 (cancel), then the prefix.
    /// @param peer the number of the connection that it came by
    Change apply(int peer, std::span<const std::byte> message);

    /// Cancels all subscriptions of a peer: its connection has ended.
    void forget(int peer) noexcept;

    /// Whether there is a subscription to a prefix of the topic, the empty one included. Asking for a topic that
    /// was not announced is misuse.
    bool wanted(std::string_view topic) const noexcept;

    /// Whether one of these subscribers takes messages, or has room for some in its queue: see judge().
    bool taken(std::string_view topic) const noexcept;

    /// Counts a message of the topic that was sent.
    void note_sent(std::string_view topic) noexcept;

    /// Finds the peers whose queues are full, so that each further message to them vanishes: those that have taken nothing
    /// while `queue_length` messages were sent to them. Such a peer counts again when it has taken something.
    /// @param takes_nothing whether a peer has taken nothing since the last call
    void judge(const std::function<bool(int peer)>& takes_nothing, std::uint64_t queue_length);

private:
    struct Topic {
        std::string name;
        int subscribers = 0;
        int takers = 0;  // of them
        std::uint64_t sent = 0;
    };
    struct Peer {
        std::vector<std::uint64_t> prefixes;  // by topic; bit k: it subscribes to the first k characters
        bool takes = true;
        std::uint64_t sent_before = 0;  // messages to it when it last took something
    };
    const Topic* find(std::string_view topic) const noexcept;
    std::uint64_t sent_to(const Peer& peer) const noexcept;
    void set_prefixes(Peer& peer, std::size_t topic, std::uint64_t prefixes) noexcept;
    void set_takes(Peer& peer, bool takes) noexcept;

    std::vector<Topic> topics_;
    std::unordered_map<int, Peer> peers_;
};

}  // namespace hertzline::stream
