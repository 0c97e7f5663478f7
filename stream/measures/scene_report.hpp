#pragma once
// What follows from a scene: masses, stiffnesses, frequencies, accuracy and step.

#include <cstdint>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/step_choice/resolve.hpp"

namespace hertzline::stream {

/// A row of the report: a quantity, its value and its unit.
struct ReportRow {
    std::string group;  ///< "spheres", "contacts", ...
    std::string label;  ///< "mass"
    std::string name;   ///< "sphere_mass_kg", for machines
    std::string unit;   ///< "kg"; "bytes" is shown in KiB and so on
    /// Empty when this scene has no such thing (a wall's mass).
    std::variant<std::monostate, double, std::int64_t, bool, std::string> value;
};

/// In the order in which they are best read. Simulates the scene's first burst for the peak overlaps: takes
/// as long as that.
std::vector<ReportRow> scene_report(const ResolvedScene& resolved);

/// A whole number, or what is beyond all counting.
decltype(ReportRow::value) report_count(double number);

/// One flat object; null where this scene has no such thing.
nlohmann::ordered_json report_json(std::span<const ReportRow> report);

}  // namespace hertzline::stream
