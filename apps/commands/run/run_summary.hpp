#pragma once
// The summary of a run, group by group. docs/measures.md explains every number of it.

#include <optional>
#include <vector>

#include "measures/run_summary.hpp"
#include "recordings/recording_set.hpp"

#include "apps/console/output.hpp"
#include "core/simulation.hpp"

namespace hertzline::app {

/// Peaks and spectra, v_out's first. Warns of a record that shows less than it seems to. @param warnings the texts are appended to it
std::vector<SummaryGroup> measure(const measures::RunRecord& record, const Scene& scene,
                                  std::optional<double> band_from_hz, measures::Warnings& warnings);

/// What the contacts carried. Warns where that is beyond Hertz's law.
SummaryGroup contacts(const measures::RunRecord& record, const Scene& scene, measures::Warnings& warnings);

/// What was warned of, for JSON: as text it has been printed.
SummaryGroup warnings_group(const measures::Warnings& warnings);

/// What was run, how long it took, and where it was saved.
SummaryGroup account(const measures::RunRecord& record, const Scene& scene, double setup_s,
                     const recordings::RecordingSet& recordings);

}  // namespace hertzline::app
