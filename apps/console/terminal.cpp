#include "apps/console/terminal.hpp"

#include <cstdlib>
#include <string_view>

#include <unistd.h>

namespace hertzline::app {

namespace {

std::string_view environment(const char* variable) {
    const char* value = std::getenv(variable);
    return value == nullptr ? "" : value;
}

}  // namespace

bool stderr_is_terminal() {
    const std::string_view kind = environment("TERM");
    return ::isatty(STDERR_FILENO) == 1 && !kind.empty() && kind != "dumb";
}

bool colour_on_stderr() {
    return stderr_is_terminal() && environment("NO_COLOR").empty();
}

}  // namespace hertzline::app
