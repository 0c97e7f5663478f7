#pragma once
// Features of stderr beyond plain lines.

namespace hertzline::app {

/// Whether stderr is a terminal with escape sequences, so that a line can be overwritten. TERM=dumb means no.
bool stderr_is_terminal();

/// Messages may be coloured on such a terminal, unless NO_COLOR is set (https://no-color.org).
bool colour_on_stderr();

}  // namespace hertzline::app
