#pragma once
// The output on stderr: messages, and the progress line. Neither ever waits for a reader or fails: text for a paused
// terminal is kept, up to a bound.

#include <string_view>

namespace hertzline::app {

/// Whether stderr is a terminal with escape sequences, so that a line can be overwritten. TERM=dumb means no.
bool stderr_is_terminal();

/// Makes spdlog write to stderr, in colour on such a terminal unless NO_COLOR is set.
void send_messages_to_stderr();

/// Writes to stderr without a level before it.
void write_message(std::string_view text) noexcept;

/// Writes text that may be skipped, such as a progress line. Does nothing while a message waits for its reader.
void write_if_read(std::string_view text) noexcept;

/// At the end: waits until every message was read or the user asks to stop.
void finish_messages() noexcept;

}  // namespace hertzline::app
