#pragma once
// JSON from files and messages of others, which may be anything.

#include <string_view>

#include <nlohmann/json.hpp>

namespace hertzline {

using Json = nlohmann::ordered_json;

/// Parses JSON that is not trusted, in a time that is proportional to its length.
/// @throws std::runtime_error when it is not JSON, is nested so deep that following it would exhaust the stack, or has
/// millions of values or objects of thousands of keys
Json json_from_outside(std::string_view text);

/// One object, on one line. Bytes that are not UTF-8 (in the name of a file) are replaced.
std::string json_text(const Json& json);

}  // namespace hertzline
