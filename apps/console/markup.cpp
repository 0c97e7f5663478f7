#include "apps/console/markup.hpp"

#include <sstream>

#include "apps/console/help.hpp"

namespace hertzline::app {

namespace {

/// The text without targets of links; code stays between backticks.
std::string without_links(std::string_view markdown) {
    std::string text;
    while (true) {
        const std::size_t middle = markdown.find("](");
        const std::size_t open =
            markdown.substr(0, middle).rfind('[');  // others before it are no link's: "[m]"
        const std::size_t end = markdown.find(')', middle);
        const std::size_t code = markdown.find('`');
        if (code < open) {  // brackets in code are no link
            const std::size_t after = markdown.find('`', code + 1);
            text += markdown.substr(0, after == std::string_view::npos ? after : after + 1);
            markdown.remove_prefix(after == std::string_view::npos ? markdown.size() : after + 1);
        } else if (open == std::string_view::npos || end == std::string_view::npos) {
            return text += markdown;
        } else {
            text += markdown.substr(0, open);
            text += markdown.substr(open + 1, middle - open - 1);
            markdown.remove_prefix(end + 1);
        }
    }
}

}  // namespace

std::string plain_text(std::string_view markdown) {
    std::string text = without_links(markdown);
    std::erase(text, '`');
    return text;
}

std::string roff_text(std::string_view text) {
    std::string escaped;
    for (const char c : text) {
        escaped += c == '\\' ? "\\e" : c == '-' ? "\\-" : std::string(1, c);
    }
    return escaped.starts_with('.') || escaped.starts_with('\'') ? "\\&" + escaped : escaped;
}

std::string roff_paragraph(std::string_view markdown) {
    std::istringstream lines(wrapped(without_links(markdown), line_width - 10));  // escapes make lines longer
    std::string roff;
    bool in_code = false;
    for (std::string line; std::getline(lines, line);) {
        for (const char c : roff_text(line)) {
            if (c == '`') {
                in_code = !in_code;
                roff += in_code ? "\\fB" : "\\fR";
            } else {
                roff += c;
            }
        }
        roff += '\n';
    }
    return roff;
}

}  // namespace hertzline::app
