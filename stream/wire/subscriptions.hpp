#pragma once
// The topics with subscribers, from the (un)subscription messages that reach a publisher.
//
// A peer subscribes to prefixes, as many as it likes: a set of them would grow with whatever peers send. Here
// a prefix is kept as one bit of each topic that begins with it, so memory is bounded by the topics, and no
// peer can crowd out another's subscription.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace hertzline::stream {

/// The topics that have a subscriber.
class Subscriptions {
public:
    /// The kind of a message.
    enum class Change {
        subscribed,    ///< a prefix of some topic, new or known already
        unsubscribed,  ///< the last subscriber of such a prefix left
        foreign,       ///< a prefix that no topic begins with
        malformed,     ///< no (un)subscription at all
    };

    /// Topics of 1 to 63 characters. @throws std::invalid_argument for others.
    explicit Subscriptions(std::span<const std::string_view> topics);

    /// Takes a message of an XPUB socket: byte 1 (subscribe) or 0 (cancel), then the prefix.
    Change apply(std::span<const std::byte> message) noexcept;

    /// Whether there is a subscription to a prefix of the topic, the empty one included. Asking for a topic that
    /// was not announced is misuse.
    bool wanted(std::string_view topic) const noexcept;

private:
    struct Topic {
        std::string name;
        std::uint64_t prefixes = 0;  // bit k: there is a subscription to the first k characters
    };
    std::vector<Topic> topics_;
};

}  // namespace hertzline::stream
