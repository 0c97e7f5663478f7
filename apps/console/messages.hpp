#pragma once
// What goes to stderr: messages, and the progress line. Neither ever waits for a reader or fails: what a paused
// terminal does not take is kept for later, up to a bound.

#include <string_view>

namespace hertzline::app {

/// From here on spdlog writes to stderr.
void send_messages_to_stderr();

/// Writes to stderr without a level before it.
void write_message(std::string_view text) noexcept;

/// Writes what may be passed over, as a progress line. Does nothing as long as a message waits for its reader.
void write_if_read(std::string_view text) noexcept;

/// At the end: waits until every message was read or the user asks to stop.
void finish_messages() noexcept;

}  // namespace hertzline::app
