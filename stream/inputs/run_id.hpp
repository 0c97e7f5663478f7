#pragma once

#include <string>

namespace hertzline::stream {

/// A new random UUID, version 4 (RFC 9562), lower case, 36 characters. @throws std::runtime_error when the
/// machine has no source of randomness.
std::string make_run_id();

}  // namespace hertzline::stream
