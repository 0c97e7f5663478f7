#include "scope/pictures/channel.hpp"

#include <algorithm>
#include <string_view>

#include "core/scene/text.hpp"

namespace hertzline::scope {

std::optional<Channel> channel_named(std::string_view name) noexcept {
    const std::size_t bracket = std::min(name.find('['), name.size());
    const auto tap = tap_named(name.substr(0, bracket));
    if (!tap || !pictured_taps.contains(*tap)) {
        return std::nullopt;
    }
    Channel channel{.tap = *tap};
    if (bracket < name.size()) {
        std::string_view number = name.substr(bracket + 1);
        const bool closed = number.ends_with(']');
        number.remove_suffix(closed ? 1 : 0);
        channel.number = parsed_number<decltype(channel.number)>(number).value_or(0);
        if (!closed || channel.number == 0) {
            return std::nullopt;
        }
    }
    return channel;
}

}  // namespace hertzline::scope
