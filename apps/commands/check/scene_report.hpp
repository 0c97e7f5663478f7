#pragma once
// What follows from a scene: masses, stiffnesses, frequencies, the cost of a run.

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/step_choice/resolve.hpp"

namespace hertzline::app {

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

}  // namespace hertzline::app
