#include "scope/pictures/channel.hpp"

#include <algorithm>
#include <charconv>

namespace hertzline::scope {

std::optional<Channel> channel_named(std::string_view name) noexcept {
    const std::size_t bracket = std::min(name.find('['), name.size());
    const auto tap = tap_named(name.substr(0, bracket));
    if (!tap || !pictured_taps.contains(*tap)) {
        return std::nullopt;
    }
    Channel channel{.tap = *tap};
    if (bracket < name.size()) {
        const char* const end = name.data() + name.size() - 1;
        const auto [stopped, error] = std::from_chars(name.data() + bracket + 1, end, channel.number);
        if (*end != ']' || stopped != end || error != std::errc{} || channel.number == 0) {
            return std::nullopt;
        }
    }
    return channel;
}

}  // namespace hertzline::scope
