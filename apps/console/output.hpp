#pragma once
// The output on stdout: data and summaries alone.

#include <span>
#include <string>
#include <string_view>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "core/scene/json.hpp"
#include "measures/quantities.hpp"

namespace hertzline::app {

enum class Format { text, json };

/// Adds --json to a subcommand.
void add_format_option(CLI::App& command, Format& format, const char* description);

/// Writes to stdout and checks that it was written.
/// @throws std::runtime_error with the system's reason
void print(std::string_view text);

/// Prints a list or a page, of which a reader such as `head` may take a part: that it has gone is no error.
/// @throws std::runtime_error with the system's reason, for any other
void print_listing(std::string_view text);

/// Prints a flat object: as JSON, or as text with a name and its value on each line.
void print_summary(const Json& summary, Format format);

using measures::SummaryGroup;

/// Prints groups: as JSON one object, as text one after another.
void print_summary(std::span<const SummaryGroup> groups, Format format);

}  // namespace hertzline::app
