#include "apps/console/output.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <stdexcept>
#include <string>
#include <system_error>

#include <fmt/format.h>
#include <unistd.h>

#include "apps/console/standard_stream.hpp"
#include "core/scene/text.hpp"

namespace hertzline::app {

namespace {

std::string value_text(std::string_view name, const Json& value) {
    if (value.is_null()) {
        return "-";
    }
    if (value.is_string()) {
        return value.get_ref<const std::string&>().empty()
                   ? "-"
                   : printable_whole(value.get_ref<const std::string&>());
    }
    if (value.is_number_float()) {
        return fmt::format("{:.6g}", value.get<double>());
    }
    if (value.is_structured()) {
        std::string text;
        const bool is_level = name.ends_with("_db");
        for (const Json& item : value) {
            text += (text.empty() ? "" : " ") + (is_level && item.is_number_float()
                                                     ? fmt::format("{:.1f}", item.get<double>())
                                                     : value_text(name, item));
        }
        return text.empty() ? "-" : text;
    }
    return json_text(value);
}

std::size_t width_of(const Json& summary) {
    std::size_t width = 0;
    for (const auto& [name, value] : summary.items()) {
        width = std::max(width, name.size());
    }
    return width;
}

/// Returns a line with name and value for each member.
std::string lines_of(const Json& summary, std::size_t width, std::string_view indent) {
    std::string text;
    for (const auto& [name, value] : summary.items()) {
        text += fmt::format("{}{:<{}}  {}\n", indent, name, width, value_text(name, value));
    }
    return text;
}

/// Returns errno, or 0.
int write_out(std::string_view text) {
    static StandardStream output(STDOUT_FILENO);
    return output.write(text);
}

void throw_unless_written(int error) {
    if (error == EAGAIN) {
        throw std::runtime_error("cannot write to standard output: it has no reader");
    }
    if (error != 0) {
        throw std::system_error(error, std::generic_category(), "cannot write to standard output");
    }
}

}  // namespace

void add_format_option(CLI::App& command, Format& format, const char* description) {
    command.add_flag_callback(
        "--json", [&format] { format = Format::json; }, description);
}

void print(std::string_view text) {
    throw_unless_written(write_out(text));
}

void print_listing(std::string_view text) {
    const int error = write_out(text);
    throw_unless_written(error == EPIPE ? 0 : error);
}

void print_summary(const Json& summary, Format format) {
    if (format == Format::json) {
        print(json_text(summary) + '\n');
        return;
    }
    print(lines_of(summary, width_of(summary), ""));
}

void print_summary(std::span<const SummaryGroup> groups, Format format) {
    if (format == Format::json) {
        print_summary(measures::summary_json(groups), format);
        return;
    }
    std::size_t width = 0;
    for (const SummaryGroup& group : groups) {
        width = std::max(width, width_of(group.values));
    }
    std::string text;
    for (const SummaryGroup& group : groups) {
        text += (text.empty() ? "" : "\n") + group.heading + '\n' + lines_of(group.values, width, "  ");
    }
    print(text);
}

}  // namespace hertzline::app
