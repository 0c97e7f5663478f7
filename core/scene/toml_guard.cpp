#include "core/scene/toml_guard.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <optional>
#include <string>
#include <utility>

namespace hertzline {

namespace {

constexpr int max_dots = 32;
constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";

Fault fault_in(int line, std::string found, std::string allowed) {
    return {"", std::move(found), std::move(allowed), Place{"", line}};
}

/// Whether the text is UTF-16: it has a byte order mark, or a NUL in every second byte of its beginning.
bool is_utf16(std::string_view text) {
    if (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF")) {
        return true;
    }
    return text.size() >= 4 && (text[0] == '\0') != (text[1] == '\0') &&
           (text[0] == '\0') == (text[2] == '\0') && (text[1] == '\0') == (text[3] == '\0');
}

/// A character outside of ASCII.
struct Character {
    std::size_t bytes = 0;  ///< 0: the text is no UTF-8
    char32_t code = 0;
};

Character character_at(std::string_view text) {
    const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
    const unsigned first = byte(0);
    const std::size_t bytes = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : first >= 0xC2 ? 2 : 0;
    if (bytes == 0 || first > 0xF4 || text.size() < bytes) {
        return {};
    }
    char32_t code = first & (0xFFU >> (bytes + 1));
    for (std::size_t i = 1; i < bytes; ++i) {
        if ((byte(i) & 0xC0U) != 0x80) {
            return {};
        }
        code = code << 6U | (byte(i) & 0x3FU);
    }
    constexpr char32_t surrogates = 0xD800;
    constexpr char32_t after_surrogates = 0xE000;
    const bool too_long = (bytes == 3 && code < 0x800) || (bytes == 4 && code < 0x10000);
    const bool none = too_long || code > 0x10FFFF || (code >= surrogates && code < after_surrogates);
    return none ? Character{} : Character{bytes, code};
}

/// Reads the text character by character, and knows whether it is in a string or a comment.
class Guard {
public:
    explicit Guard(std::string_view text) : rest_(text) {}

    tl::expected<std::string, Fault> clean() && {
        while (!rest_.empty()) {
            if (auto fault = take()) {
                return tl::unexpected(*std::move(fault));
            }
        }
        return std::move(clean_);
    }

private:
    std::optional<Fault> take() {
        const char c = rest_.front();
        if (c == '\n' || c == '\r') {
            end_line(rest_.starts_with("\r\n") ? 2 : 1);
            return std::nullopt;
        }
        if ((c < 0x20 || c > 0x7E) && c != '\t') {
            return take_other();
        }
        if (in_comment_) {
            pass(1);
            return std::nullopt;
        }
        if (c == '#' && quote_.empty()) {
            in_comment_ = true;
            pass(1);
            return std::nullopt;
        }
        if (c == ',' && quote_.empty()) {
            dots_ = 0;  // the next entry of a list: no dotted key goes on behind it
        }
        // "..." is no dotted key.
        if (c == '.' && !rest_.substr(1).starts_with('.') && ++dots_ > max_dots) {
            return fault_in(line_, "more than 32 dots in a line", "section.key, and decimal points");
        }
        keep(c == '"' || c == '\'' ? take_quote(c) : c == '\\' && quote_.starts_with('"') ? escape() : 1);
        return std::nullopt;
    }

    /// Takes what is not ASCII: allowed in a comment.
    std::optional<Fault> take_other() {
        const auto byte = static_cast<unsigned char>(rest_.front());
        const Character found = byte < 0x80 ? Character{} : character_at(rest_);
        if (in_comment_ && found.bytes > 0) {
            pass(found.bytes);
            return std::nullopt;
        }
        std::array<char, 32> name{};
        if (found.bytes > 0) {
            std::snprintf(name.data(), name.size(), "the character U+%04X",
                          static_cast<unsigned>(found.code));
        } else {
            std::snprintf(name.data(), name.size(), "byte 0x%02X", byte);
        }
        return fault_in(
            line_, name.data() + (" in column " + std::to_string(column_)),
            in_comment_ ? "UTF-8 in comments" : "printable ASCII, tabs and line ends; UTF-8 in comments");
    }

    /// Begins or ends a string. Returns the bytes of its quotes.
    std::size_t take_quote(char c) {
        const std::string three(3, c);
        const std::string_view found = rest_.starts_with(three) ? rest_.substr(0, 3) : rest_.substr(0, 1);
        if (quote_.empty()) {
            quote_ = found;
            return found.size();
        }
        if (rest_.starts_with(quote_)) {
            return std::exchange(quote_, {}).size();
        }
        return 1;
    }

    std::size_t escape() const {
        const bool printable = rest_.size() > 1 && rest_[1] >= 0x20 && rest_[1] <= 0x7E;
        return printable ? 2 : 1;
    }

    void end_line(std::size_t bytes) {
        clean_ += '\n';
        rest_.remove_prefix(bytes);
        ++line_;
        column_ = 1;
        dots_ = 0;
        in_comment_ = false;
        if (quote_.size() == 1) {
            quote_ = {};  // a fault, which the parser finds
        }
    }
    void pass(std::size_t bytes) {
        rest_.remove_prefix(bytes);
        column_ += bytes;
    }
    void keep(std::size_t bytes) {
        clean_ += rest_.substr(0, bytes);
        pass(bytes);
    }

    std::string_view rest_;
    std::string clean_;
    std::string_view quote_;  // of the present string; empty: outside
    bool in_comment_ = false;
    int line_ = 1;
    std::size_t column_ = 1;
    int dots_ = 0;
};

}  // namespace

tl::expected<std::string, Fault> guarded_toml(std::string_view text) {
    if (text.size() > max_scene_bytes) {
        return tl::unexpected(fault_in(0, std::to_string(text.size()) + " bytes",
                                       "at most " + std::to_string(max_scene_bytes) + " bytes"));
    }
    if (is_utf16(text)) {
        return tl::unexpected(
            fault_in(1, "text in UTF-16", "UTF-8 or ASCII: choose it where the editor saves the file"));
    }
    text.remove_prefix(text.starts_with(byte_order_mark) ? byte_order_mark.size() : 0);
    return Guard(text).clean();
}

}  // namespace hertzline
