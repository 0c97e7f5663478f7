#pragma once
// What goes to stdout: data and summaries, nothing else.

#include <span>
#include <string>
#include <string_view>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "stream/measures/run_summary.hpp"

namespace hertzline::app {

using Json = nlohmann::ordered_json;

enum class Format { text, json };

/// Adds --json to a subcommand.
void add_format_option(CLI::App& command, Format& format, const char* description);

/// Writes to stdout and makes sure that it got there.
/// @throws std::runtime_error with the system's reason
void print(std::string_view text);

/// One object, on one line. Bytes that are not UTF-8 (in the name of a file) are replaced.
std::string json_text(const Json& json);

/// A flat object: as JSON, or as text with a name and its value on each line.
void print_summary(const Json& summary, Format format);

using stream::SummaryGroup;

/// As JSON one object, as text the groups one after another.
void print_summary(std::span<const SummaryGroup> groups, Format format);

}  // namespace hertzline::app
