#include "measures/tap_names.hpp"

#include "core/scene/faults.hpp"
#include "core/scene/text.hpp"
#include "measures/run.hpp"

namespace hertzline::measures {

std::vector<std::string> names_of(TapSet taps) {
    std::vector<std::string> names;
    for (const Tap tap : taps) {
        names.emplace_back(row_of(tap).name);
    }
    return names;
}

tl::expected<Tap, std::string> find_tap(std::string_view name, TapSet allowed) {
    if (const auto tap = tap_named(name); tap && allowed.contains(*tap)) {
        return *tap;
    }
    const std::vector<std::string> names = names_of(allowed);
    return tl::unexpected("found " + quoted_briefly(name) + ", allowed: " + comma_separated(names) +
                          suggestion(name, names));
}

TapSet taps_named(std::string_view subject, const std::vector<std::string>& names, TapSet allowed,
                  Faults& faults) {
    TapSet taps;
    for (const std::string& name : names) {
        if (const auto tap = faults.value_of(subject, find_tap(name, allowed))) {
            taps |= *tap;
        }
    }
    return taps;
}

TapSet measurable_among(std::span<const std::string> names) noexcept {
    TapSet taps;
    for (const std::string& name : names) {
        if (const auto tap = tap_named(name)) {
            taps |= TapSet(*tap) & measurable_taps;
        }
    }
    return taps;
}

}  // namespace hertzline::measures
