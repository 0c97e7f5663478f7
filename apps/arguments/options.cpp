#include "apps/arguments/options.hpp"

#include <cmath>

#include <fmt/format.h>

#include "apps/command.hpp"
#include "core/scene/text.hpp"

namespace hertzline::app {

std::string missing_name(const std::string& value) {
    return value.empty() ? "found an empty name, allowed: the name of a file" : "";
}

CLI::Option* add_repeatable_option(CLI::App& app, const char* names, std::vector<std::string>& values,
                                   const std::string& description) {
    return app.add_option(names, values, description)
        ->expected(1)
        ->allow_extra_args(false)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
}

std::vector<std::string> names_of(TapSet taps) {
    std::vector<std::string> names;
    for (const Tap tap : taps) {
        names.emplace_back(row_of(tap).name);
    }
    return names;
}

Tap tap_argument(const char* option, const std::string& name, TapSet allowed) {
    if (const auto tap = tap_named(name); tap && allowed.contains(*tap)) {
        return *tap;
    }
    const std::vector<std::string> names = names_of(allowed);
    throw WrongUse(fmt::format("{}: found {}, allowed: {}{}", option, quoted_briefly(name),
                               comma_separated(names), suggestion(name, names)));
}

void require_positive(const char* option, double value) {
    if (!(value > 0) || !std::isfinite(value)) {
        throw WrongUse(
            fmt::format("{}: found {}, allowed: a finite number above 0", option, number_text(value)));
    }
}

}  // namespace hertzline::app
