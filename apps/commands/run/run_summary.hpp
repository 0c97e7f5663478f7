#pragma once
// The summary of a run, group by group. docs/measures.md explains every number of it.

#include <optional>
#include <vector>

#include "apps/commands/run/run_record.hpp"
#include "apps/console/output.hpp"
#include "core/simulation.hpp"
#include "core/step_choice/resolve.hpp"
#include "stream/recordings/recording_set.hpp"

namespace hertzline::app {

/// Peaks and spectra, v_out's first. Warns of a record that shows less than it seems to.
std::vector<SummaryGroup> measure(const RunRecord& record, const Scene& scene,
                                  std::optional<double> band_from_hz);

/// What the contacts carried. Warns where that is beyond Hertz's law.
SummaryGroup contacts(Simulation& simulation);

/// How far the result can be trusted.
SummaryGroup trust(Simulation& simulation, const ResolvedScene& resolved);

/// What was run, how long it took, and where it was saved.
SummaryGroup account(const Simulation& simulation, double setup_s, const RunRecord& record,
                     const stream::RecordingSet& recordings);

}  // namespace hertzline::app
