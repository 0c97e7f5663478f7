#pragma once
// Claims of fuzz functions on the code under test.

#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>

#include "core/scene/json.hpp"

namespace hertzline::fuzz {

/// Ends the program unless the claim holds: the fuzzer then keeps the input.
inline void claim(bool holds, const char* what, const std::string& evidence = "") {
    if (!holds) {
        std::fprintf(stderr, "claim does not hold: %s\n%s\n", what, evidence.c_str());
        std::abort();
    }
}

/// Whether the text is UTF-8, as the library of JSON judges it.
inline bool is_utf8(const std::string& text) {
    try {
        static_cast<void>(Json(text).dump());
        return true;
    } catch (const Json::exception&) {
        return false;
    }
}

/// Claims that a message is fit for a terminal: lines of UTF-8 of bounded length, without control characters and those that turn the
/// direction of writing.
inline void claim_message(const std::string& text, std::size_t longest) {
    claim(!text.empty(), "a fault has a message");
    claim(is_utf8(text), "a message is UTF-8", text);
    for (std::size_t i = 0; i < text.size(); ++i) {
        const auto byte = [&](std::size_t of) { return static_cast<unsigned char>(text[i + of]); };
        const bool ascii = (byte(0) < 0x20 && text[i] != '\n') || byte(0) == 0x7F;
        const bool second_set = byte(0) == 0xC2 && byte(1) < 0xA0;
        const bool turns = byte(0) == 0xE2 && ((byte(1) == 0x80 && byte(2) >= 0xA8 && byte(2) <= 0xAE) ||
                                               (byte(1) == 0x81 && byte(2) >= 0xA6 && byte(2) <= 0xA9));
        claim(!ascii && !second_set && !turns, "a message is printable", text);
    }
    claim(text.size() <= longest, "a message is short", text);
}

}  // namespace hertzline::fuzz
