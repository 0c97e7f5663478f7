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

void require_positive(const char* option, double value) {
    if (!(value > 0) || !std::isfinite(value)) {
        throw WrongUse(
            fmt::format("{}: found {}, allowed: a finite number above 0", option, number_text(value)));
    }
}

}  // namespace hertzline::app
