#pragma once
// Taps by their names, as options and calls give them.

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <tl/expected.hpp>

#include "hertzline/taps.hpp"

namespace hertzline {
class Faults;
}

namespace hertzline::measures {

/// The names of the taps, in the order of the set.
std::vector<std::string> names_of(TapSet taps);

/// Returns the tap of that name, or a fault.
tl::expected<Tap, std::string> find_tap(std::string_view name, TapSet allowed);

/// The taps of those names; the faults of other names are added. @param subject of the faults, as "--columns"
TapSet taps_named(std::string_view subject, const std::vector<std::string>& names, TapSet allowed,
                  Faults& faults);

/// The measurable taps among the names; other names are passed over.
TapSet measurable_among(std::span<const std::string> names) noexcept;

}  // namespace hertzline::measures
