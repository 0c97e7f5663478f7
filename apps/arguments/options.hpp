#pragma once
// What the options of several subcommands have in common.

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "core/taps.hpp"

namespace hertzline::app {

/// For CLI::Option::check(): the fault of an empty value, "" when there is none. A file needs a name, and an
/// empty one would mean that the option was not given.
std::string missing_name(const std::string& value);

/// Adds an option that may be given several times, with one value each time: -o a.csv -o b.csv.
CLI::Option* add_repeatable_option(CLI::App& app, const char* names, std::vector<std::string>& values,
                                   const std::string& description);

/// The names of the taps, in the order of the set.
std::vector<std::string> names_of(TapSet taps);

/// The tap that the option's value names. @throws WrongUse unless it is one of the allowed ones
Tap tap_argument(const char* option, const std::string& name, TapSet allowed);

/// @throws WrongUse unless the option's value is a positive, finite number
void require_positive(const char* option, double value);

}  // namespace hertzline::app
