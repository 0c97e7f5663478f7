#include "apps/console/help.hpp"

#include <sstream>

namespace hertzline::app {

std::string wrapped(const std::string& text, std::size_t columns) {
    std::istringstream words(text);
    std::string lines;
    std::size_t taken = 0;
    for (std::string word; words >> word;) {
        const bool fits = taken + 1 + word.size() <= columns;
        lines += taken == 0 ? "" : fits ? " " : "\n";
        taken = taken > 0 && fits ? taken + 1 + word.size() : word.size();
        lines += word;
    }
    return lines;
}

std::string HelpFormatter::make_option_desc(const CLI::Option* option) const {
    return wrapped(option->get_description(), line_width - get_column_width());
}

std::string HelpFormatter::make_subcommand(const CLI::App* subcommand) const {
    std::ostringstream out;
    CLI::detail::format_help(out, subcommand->get_name(),
                             wrapped(subcommand->get_description(), line_width - get_column_width()),
                             get_column_width());
    return out.str();
}

std::string HelpFormatter::make_footer(const CLI::App* app) const {
    std::istringstream lines(app->get_footer());
    std::string footer;
    for (std::string line; std::getline(lines, line);) {
        footer += (line.starts_with(' ') ? line : wrapped(line, line_width)) + '\n';
    }
    return footer;
}

}  // namespace hertzline::app
