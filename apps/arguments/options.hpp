#pragma once
// The common parts of several subcommands' options.

#include <optional>
#include <span>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "core/scene/faults.hpp"
#include "hertzline/taps.hpp"

namespace hertzline::app {

/// For CLI::Option::check(): the fault of an empty value, else "". A file needs a name, and an
/// empty one would mean that the option was not given.
std::string missing_name(const std::string& value);

/// Whether a value follows the option; none follows a flag.
bool takes_value(const CLI::Option& option);

/// The word that stands for the option's value in --help: "KEY=VALUE"; of a positional its name.
std::string word_of(const CLI::Option& option);

/// Adds an option that may be given several times, with one value each time: -o a.csv -o b.csv.
CLI::Option* add_repeatable_option(CLI::App& app, const char* names, std::vector<std::string>& values,
                                   const std::string& description);

/// Adds --columns, which names the taps that recordings hold. @param there those that the help names
CLI::Option* add_columns_option(CLI::App& app, std::vector<std::string>& names, TapSet there);

/// Adds --wav-scale.
CLI::Option* add_wav_scale_option(CLI::App& app, std::optional<double>& scale);

/// Adds --target, the instruction set, which takes effect as it is parsed. Machines that share work must agree on it:
/// results have other bits with another one. @throws WrongUse, as it is parsed, for a target that this processor lacks
void add_target_option(CLI::App& app);

/// Adds the fault of a scale that is not positive, or that no WAV among the files needs.
void check_wav_scale(std::optional<double> scale, std::span<const std::string> files, Faults& faults);

/// Adds the fault of each recording whose ending is unknown, or that is named twice.
void check_recordings(std::span<const std::string> files, Faults& faults);

}  // namespace hertzline::app
