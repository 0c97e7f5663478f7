#pragma once
// What follows from a scene: masses, stiffnesses, frequencies, what contacts carry, the cost of a run.

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include <Eigen/Core>

#include "core/scene/scene.hpp"
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

/// The first burst and half as long again [s].
double first_burst_s(const Scene& scene);

/// Overlaps of the contacts at their largest in so many seconds [m]; nothing when that takes too many steps, or fails.
/// Simulates them. @param scene is resolved
std::optional<Eigen::ArrayXd> peak_overlaps(const Scene& scene, double duration_s);

/// Warns of contacts that are pressed too deep, or harder than their materials bear, at these overlaps; at rest where they
/// are not known. @param name of the scene, as the user gave it
void warn_of_contacts(const std::string& name, const Scene& scene,
                      const std::optional<Eigen::ArrayXd>& peaks);

/// In the order in which they are best read. @param peaks overlaps at their largest [m], where they are known
std::vector<ReportRow> scene_report(const ResolvedScene& resolved,
                                    const std::optional<Eigen::ArrayXd>& peaks);

}  // namespace hertzline::app
