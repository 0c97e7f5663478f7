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
        topics_.push_back({std::string(topic), 0});
    }
}

Subscriptions::Change Subscriptions::apply(std::span<const std::byte> message) noexcept {
    if (message.empty() || std::to_integer<unsigned>(message[0]) > 1) {
        return Change::malformed;
    }
    const bool subscribes = message[0] == std::byte{1};
    const std::string_view prefix(reinterpret_cast<const char*>(message.data()) + 1, message.size() - 1);
    bool known = false;
    for (Topic& topic : topics_) {
        if (!topic.name.starts_with(prefix)) {
            continue;
        }
        known = true;
        const std::uint64_t bit = std::uint64_t{1} << prefix.size();
        topic.prefixes = subscribes ? topic.prefixes | bit : topic.prefixes & ~bit;
    }
    if (!known) {
        return Change::foreign;
    }
    return subscribes ? Change::subscribed : Change::unsubscribed;
}

bool Subscriptions::wanted(std::string_view topic) const noexcept {
    const auto found =
        std::find_if(topics_.begin(), topics_.end(), [topic](const Topic& t) { return t.name == topic; });
    assert(found != topics_.end() && "a topic that was not announced");
    return found != topics_.end() && found->prefixes != 0;
}

}  // namespace hertzline::stream
