#pragma once
// hertzline sweep: many scenes, a row each.

#include "apps/command.hpp"
#include "apps/commands/sweep/sweep_crew.hpp"

namespace hertzline::app {

/// The subcommand, whose points the crew runs. @param crew outlives what is returned
Run add_sweep(CLI::App& app, SweepCrew& crew);

}  // namespace hertzline::app
