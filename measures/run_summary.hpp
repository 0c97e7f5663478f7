#pragma once
// The summary of a run, group by group: what `hertzline run` prints, and a row of `hertzline sweep`. docs/measures.md explains
// every number of it.

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "measures/run_record.hpp"
#include "measures/spectrum.hpp"

#include "core/scene/json.hpp"
#include "core/simulation.hpp"
#include "core/step_choice/resolve.hpp"

namespace hertzline::measures {

/// Lines of a summary that belong together.
struct SummaryGroup {
    std::string heading;  ///< above the lines, as text
    Json values;          ///< a flat object
    std::string member;  ///< in JSON the values stand in an object of this name; empty: in the summary itself
};

/// What to warn of, a sentence each.
using Warnings = std::vector<std::string>;

/// What is odd about a scene before it runs, and whether it keeps the accuracy that was asked for.
Warnings scene_warnings(const Resolution& resolved);

/// Peaks and spectra, v_out's first. Warns of a record that shows less than it seems to.
/// @param analyser for records of that length and rate @param band_from_hz as SpectrumAnalyser::analyse
std::vector<SummaryGroup> measures_of_run(const RunRecord& record, const Scene& scene,
                                          SpectrumAnalyser& analyser, std::optional<double> band_from_hz,
                                          Warnings& warnings);

/// What the contacts carried. Warns where that is beyond Hertz's law or the strength of a material.
SummaryGroup contacts_of_run(const RunRecord& record, const Scene& scene, Warnings& warnings);

/// How far the result can be trusted.
SummaryGroup trust_of_run(const RunRecord& record, const Resolution& resolved);

/// What was run: simulated time, rows, integrator and steps.
SummaryGroup account_of_run(const RunRecord& record, const Scene& scene);

/// Adds how long the set-up and the simulation took, and the real-time factor, to an account.
void add_times(SummaryGroup& account, double setup_s, double wall_s);

/// Adds the scene's hash and the program's version to an account.
void add_identity(SummaryGroup& account, const Scene& scene);

/// All of it as one object.
Json summary_json(std::span<const SummaryGroup> groups);

/// Of a scene whose accuracy is missed: by how much, and why; of one that may miss it: what is not known. Nothing when it is met.
std::optional<std::string> missed_accuracy(const Resolution& resolved);

}  // namespace hertzline::measures
