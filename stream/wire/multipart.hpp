#pragma once
// Messages of several parts, sent and received whole. Neither waits, and a signal does not tear a message.

#include <cstddef>
#include <span>

#include <zmq.hpp>

namespace hertzline::stream {

/// Sends the parts as one message. False when ZeroMQ refused one of them: then no subscriber gets the message.
bool send_parts(zmq::socket_t& socket, std::span<const std::span<const std::byte>> parts) noexcept;

/// The same, and `last` behind the parts. It is handed over to ZeroMQ, not copied.
bool send_parts(zmq::socket_t& socket, std::span<const std::span<const std::byte>> parts,
                zmq::message_t last) noexcept;

/// Receives the next message. Parts that `parts` has no room for are read over its last one.
/// @returns how many parts the message had, also when it had more than there is room for; 0 when none came
std::size_t receive_parts(zmq::socket_t& socket, std::span<zmq::message_t> parts) noexcept;

}  // namespace hertzline::stream
