#pragma once
// JSON from files and messages of others, which may be anything.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

namespace hertzline {

using Json = nlohmann::ordered_json;

/// Parses JSON that is not trusted, in a time that is proportional to its length.
/// @throws std::runtime_error when it is not JSON, is nested so deep that following it would exhaust the stack, or has
/// millions of values or objects of thousands of keys. @param subject begins the message
Json json_from_outside(std::string_view text, std::string_view subject = "description");

/// A scene with a million samples of a recorded drive, and more [bytes].
inline constexpr std::size_t largest_scene_json = std::size_t{32} << 20;

/// Parses a message that should be an object; null when it is none, is larger than that or is refused by json_from_outside().
Json object_from_outside(std::string_view text, std::size_t most_bytes = std::size_t{1} << 20);

/// Reads members of JSON from outside by their paths: "scene/drive/frequency_hz". A member that is missing, or of another type,
/// reads as nothing. Refers to the JSON.
class OutsideJson {
public:
    explicit OutsideJson(const Json& json) noexcept : json_(json) {}

    /// Any value; null when it is missing.
    const Json& at(std::string_view path) const;
    /// "" when it is missing.
    std::string text(std::string_view path) const;
    std::optional<double> number(std::string_view path) const;
    /// A whole number of at least 0.
    std::optional<std::int64_t> count(std::string_view path) const;

private:
    const Json& json_;
};

/// One object, on one line. Bytes that are not UTF-8 (in the name of a file) are replaced.
std::string json_text(const Json& json);

/// The same in ASCII alone, for files: other characters are escaped.
std::string ascii_json_text(const Json& json);

}  // namespace hertzline
