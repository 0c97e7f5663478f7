#pragma once
// hertzline sweep --merge: joins the journals of all parts.

#include "apps/command.hpp"
#include "apps/commands/sweep/sweep_options.hpp"

namespace hertzline::app {

/// Writes the tables. @throws WrongUse when the journals are not the parts of one sweep, std::runtime_error when a part is not complete
Exit merge_parts(const SweepOptions& options);

}  // namespace hertzline::app
