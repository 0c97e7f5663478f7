#pragma once
// Claims of fuzz functions on the code under test.

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>

namespace hertzline::fuzz {

/// Ends the program unless the claim holds: the fuzzer then keeps the input.
inline void claim(bool holds, const char* what, const std::string& evidence = "") {
    if (!holds) {
        std::fprintf(stderr, "claim does not hold: %s\n%s\n", what, evidence.c_str());
        std::abort();
    }
}

/// Claims that a message is fit for a terminal: lines of printable ASCII of bounded length.
inline void claim_message(const std::string& text, std::size_t longest) {
    const auto printable = [](char c) { return (c >= ' ' && c <= '~') || c == '\n'; };
    claim(!text.empty(), "a fault has a message");
    claim(std::all_of(text.begin(), text.end(), printable), "a message is printable", text);
    claim(text.size() <= longest, "a message is short", text);
}

}  // namespace hertzline::fuzz
