#pragma once
// The report of a scene: masses, stiffnesses, frequencies, contact pressures, accuracy and step.

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include <Eigen/Core>

#include "core/scene/json.hpp"
#include "hertzline/resolve.hpp"
#include "hertzline/scene.hpp"

namespace hertzline::measures {

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

/// The largest overlaps of the contacts [m], of each element of an array.
using PeakOverlaps = std::vector<Eigen::ArrayXd>;

/// Returns the largest overlaps over a time; nothing when that takes too many steps, or fails. Simulates them.
/// @param scene is resolved
std::optional<PeakOverlaps> peak_overlaps(const Scene& scene, double duration_s);

/// Returns warnings at these overlaps, of contacts that are pressed too deep, or harder than their materials bear; at
/// rest where overlaps are not known.
std::vector<std::string> contact_warnings(const Scene& scene, const std::optional<PeakOverlaps>& peaks);

/// The same, and warnings of a run that ends before its wave or its sound arrives: those of `check`.
std::vector<std::string> check_warnings(const Scene& scene, const std::optional<PeakOverlaps>& peaks);

/// In the order in which they are best read. @param peaks overlaps at their largest [m], where they are known
std::vector<ReportRow> scene_report(const Resolution& resolved, const std::optional<PeakOverlaps>& peaks);

/// A whole number, or a floating-point number beyond its range.
decltype(ReportRow::value) report_count(double number);

/// One flat object; null where this scene has no such thing.
Json report_json(std::span<const ReportRow> report);

}  // namespace hertzline::measures
