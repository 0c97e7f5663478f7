#pragma once
// The instruction set: --target. Results have other bits with another one, so that machines which share work must agree on it.

#include <CLI/CLI.hpp>

namespace hertzline::app {

/// Adds --target, which takes effect as it is parsed. @throws WrongUse, as it is parsed, for a target that this
/// processor lacks
void add_target_option(CLI::App& app);

}  // namespace hertzline::app
