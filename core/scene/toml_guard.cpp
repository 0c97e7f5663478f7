#include "core/scene/toml_guard.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <optional>
#include <string>
#include <utility>

#include "core/scene/text.hpp"

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
            return take_other(first_character(rest_));
        }
        if (in_comment_) {
            pass(1, 1);
            return std::nullopt;
        }
        if (c == '#' && quote_.empty()) {
            in_comment_ = true;
            pass(1, 1);
            return std::nullopt;
        }
        if (c == ',' && quote_.empty()) {
            dots_ = 0;  // the next entry of a list: no dotted key goes on behind it
        }
        const bool escapes = c == '\\' && quote_.starts_with('"');
        if (escapes && rest_.size() > 1 && static_cast<unsigned char>(rest_[1]) >= 0x80) {
            return fault_in(line_,
                            "an escape of another character than TOML's in column " + std::to_string(column_),
                            R"(\\ for a backslash, \" for a quote, \n, \t, \u00B5)");
        }
        // "..." is no dotted key.
        if (c == '.' && !rest_.substr(1).starts_with('.') && ++dots_ > max_dots) {
            return fault_in(line_, "more than 32 dots in a line", "section.key, and decimal points");
        }
        keep(c == '"' || c == '\'' ? take_quote(c) : escapes ? escape() : 1);
        return std::nullopt;
    }

    /// Takes a byte or character that is not printable ASCII: allowed in a comment, and, escaped for the library, in double quotes.
    std::optional<Fault> take_other(Character found) {
        const bool is_wide = found.bytes > 1;
        if (is_wide && (in_comment_ || quote_.starts_with('"'))) {
            clean_ += in_comment_ ? "" : escaped(found.code);
            pass(found.bytes, 1);
            return std::nullopt;
        }
        std::array<char, 32> name{};
        std::snprintf(
            name.data(), name.size(), is_wide ? "the character U+%04X" : "byte 0x%02X",
            is_wide ? static_cast<unsigned>(found.code) : static_cast<unsigned char>(rest_.front()));
        return fault_in(line_, name.data() + (" in column " + std::to_string(column_)),
                        in_comment_
                            ? "UTF-8 in comments"
                            : "printable ASCII, tabs and line ends; UTF-8 in comments and double quotes");
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
    void pass(std::size_t bytes, std::size_t columns) {
        rest_.remove_prefix(bytes);
        column_ += columns;
    }
    void keep(std::size_t bytes) {
        clean_ += rest_.substr(0, bytes);
        pass(bytes, bytes);
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
