#pragma once
// The look of --help.

#include <string>

#include <CLI/CLI.hpp>

namespace hertzline::app {

inline constexpr std::size_t line_width = 80;

/// Wraps words into lines of at most that many characters, unless a word is longer.
std::string wrapped(const std::string& text, std::size_t columns);

/// Keeps to 80 columns. In a footer lines that begin with a blank stay as they are: they are commands.
class HelpFormatter : public CLI::Formatter {
public:
    std::string make_option_desc(const CLI::Option* option) const override;
    std::string make_subcommand(const CLI::App* subcommand) const override;
    std::string make_footer(const CLI::App* app) const override;
};

}  // namespace hertzline::app
