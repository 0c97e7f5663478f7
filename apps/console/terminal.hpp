#pragma once
// What stderr can show besides plain lines.

namespace hertzline::app {

/// A terminal that takes escape sequences, so a line can be written over. TERM=dumb says that it does not.
bool stderr_is_terminal();

/// Messages may be coloured on such a terminal, unless NO_COLOR is set (https://no-color.org).
bool colour_on_stderr();

}  // namespace hertzline::app
