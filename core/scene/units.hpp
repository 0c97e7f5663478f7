#pragma once
// Numbers with their units, as people write them: "3 um", "73kHz", "2.7 g/cm^3".

#include <optional>
#include <string>
#include <string_view>

namespace hertzline {

/// Whether the text is a number and a word behind it, known as a unit or not.
bool has_unit(std::string_view text) noexcept;

/// The number in the unit that is wanted: the double nearest to the decimal text, as "3 um" and 3e-6 are the same. Nothing where the
/// text has no unit, an unknown one, or one of another quantity. Prefixes are those of the SI from p to G, and c.
/// @param wanted "m", "kg/s"; empty: nothing has it
std::optional<double> number_in_unit(std::string_view text, std::string_view wanted);

/// Units for a message: "m, with any prefix, as um or mm".
std::string units_like(std::string_view wanted);

}  // namespace hertzline
