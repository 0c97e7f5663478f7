#include "recordings/formats/npy_header.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstddef>
#include <stdexcept>

#include <fmt/format.h>

#include "recordings/files/input_file.hpp"

namespace hertzline::recordings {
namespace {

using namespace std::string_literals;
using namespace std::string_view_literals;

constexpr std::string_view magic = "\x93NUMPY"sv;
constexpr std::size_t alignment = 64;                            // of the data, as the format asks for
constexpr std::uint64_t max_count = std::uint64_t{1} << 32;      // numbers of a field
constexpr std::size_t max_count_digits = 20;                     // of a uint64_t
constexpr std::size_t max_header_bytes = std::size_t{64} << 20;  // a million spheres

std::string little_endian(std::size_t number, std::size_t bytes) {
    std::string text;
    for (std::size_t i = 0; i < bytes; ++i) {
        text += static_cast<char>((number >> (8 * i)) & 0xff);
    }
    return text;
}

std::string shape_text(const std::vector<std::uint64_t>& shape) {
    std::string text = "(";
    for (const std::uint64_t length : shape) {
        text += std::to_string(length) + ", ";
    }
    if (shape.size() > 1) {
        text.resize(text.size() - 2);
    } else if (shape.size() == 1) {
        text.pop_back();  // "(5,)"
    }
    return text + ")";
}

std::string type_text(const std::vector<NpyField>& fields) {
    if (fields.size() == 1 && fields.front().name.empty()) {
        return "'" + fields.front().type + "'";
    }
    std::string text = "[";
    for (const NpyField& field : fields) {
        const std::string shape = field.count > 1 ? ", " + shape_text({field.count}) : "";
        text += (text.size() > 1 ? ", ('" : "('") + field.name + "', '" + field.type + "'" + shape + ")";
    }
    return text + "]";
}

/// Reads the dictionary of a header: only strings, True and False, whole numbers, tuples and lists of pairs.
class DictionaryParser {
public:
    explicit DictionaryParser(std::string_view text) : text_(text) {}

    NpyHeader header() {
        NpyHeader header;
        int found = 0;
        expect("{");
        while (!take("}")) {
            const std::string key = string();
            expect(":");
            if (key == "descr") {
                header.fields = fields();
            } else if (key == "fortran_order") {
                header.fortran_order = take("True");
                if (!header.fortran_order) {
                    expect("False");
                }
            } else if (key == "shape") {
                header.shape = shape();
            } else {
                fail("the keys descr, fortran_order and shape");
            }
            ++found;
            if (!take(",")) {
                expect("}");
                break;
            }
        }
        skip_space();
        if (found != 3 || at_ != text_.size()) {
            fail("descr, fortran_order, shape and the end");
        }
        return header;
    }

private:
    [[noreturn]] void fail(std::string_view expected) const {
        throw std::runtime_error(fmt::format("array header, character {}: expected {}", at_ + 1, expected));
    }

    void skip_space() { at_ = std::min(text_.find_first_not_of(" \n", at_), text_.size()); }

    bool take(std::string_view word) {
        skip_space();
        if (!text_.substr(at_).starts_with(word)) {
            return false;
        }
        at_ += word.size();
        return true;
    }

    void expect(std::string_view word) {
        if (!take(word)) {
            fail(word);
        }
    }

    std::string string() {
        const std::string_view quote = take("\"") ? "\"" : "'";
        if (quote == "'") {
            expect("'");
        }
        const std::size_t end = text_.find_first_of("'\"\\\n", at_);
        if (end == std::string_view::npos || text_[end] != quote.front()) {
            fail("a string without escapes");
        }
        const std::string_view content = text_.substr(at_, end - at_);
        at_ = end + 1;
        return std::string(content);
    }

    /// Takes the name of a field, or its title and name.
    std::string name() {
        if (!take("(")) {
            return string();
        }
        string();
        expect(",");
        std::string name = string();
        expect(")");
        return name;
    }

    std::vector<NpyField> fields() {
        if (!take("[")) {
            return {{"", string()}};
        }
        std::vector<NpyField> fields;
        while (!take("]")) {
            expect("(");
            NpyField field{name(), {}};
            expect(",");
            field.type = string();
            if (take(",")) {
                for (const std::uint64_t length : shape()) {
                    if (length > max_count / std::max<std::uint64_t>(1, field.count)) {
                        fail("fewer numbers");
                    }
                    field.count *= length;
                }
            }
            expect(")");
            fields.push_back(std::move(field));
            if (!take(",")) {
                expect("]");
                break;
            }
        }
        return fields;
    }

    std::vector<std::uint64_t> shape() {
        std::vector<std::uint64_t> shape;
        expect("(");
        while (!take(")")) {
            skip_space();
            std::uint64_t length = 0;
            const auto [end, error] =
                std::from_chars(text_.data() + at_, text_.data() + text_.size(), length);
            if (error != std::errc()) {
                fail("a length");
            }
            at_ = static_cast<std::size_t>(end - text_.data());
            take("L");  // of Python 2
            shape.push_back(length);
            if (!take(",")) {
                expect(")");
                break;
            }
        }
        return shape;
    }

    std::string_view text_;
    std::size_t at_ = 0;
};

}  // namespace

std::string npy_header(const NpyHeader& header) {
    std::string text =
        fmt::format("{{'descr': {}, 'fortran_order': {}, 'shape': {}, }}", type_text(header.fields),
                    header.fortran_order ? "True" : "False", shape_text(header.shape));
    const std::size_t digits = header.shape.empty() ? 0 : std::to_string(header.shape.front()).size();
    const std::size_t reserved = header.shape.empty() ? 0 : max_count_digits - digits;
    const auto padded = [&](std::size_t preamble) {  // with the newline at its end
        const std::size_t bytes = preamble + text.size() + reserved + 1;
        return (bytes + alignment - 1) / alignment * alignment - preamble;
    };
    const bool is_short = padded(magic.size() + 4) <= 0xffff;
    const std::size_t preamble = magic.size() + (is_short ? 4 : 6);
    const std::size_t length = padded(preamble);
    text.resize(length - 1, ' ');
    return std::string(magic) + (is_short ? "\x01\x00"s : "\x02\x00"s) +
           little_endian(length, is_short ? 2 : 4) + text + "\n";
}

NpyHeader read_npy_header(InputFile& file) {
    if (file.text(magic.size(), "the array's magic number") != magic) {
        cannot_read(file.path(), "not a .npy array: it does not begin with \\x93NUMPY");
    }
    std::array<unsigned char, 6> numbers{};  // version, then the length
    const auto bytes = std::as_writable_bytes(std::span(numbers));
    file.read(bytes.first(2), "the array's version");
    if (numbers[0] < 1 || numbers[0] > 3 || numbers[1] != 0) {
        cannot_read(file.path(), fmt::format("array header of version {}.{}, allowed: 1.0 to 3.0", numbers[0],
                                             numbers[1]));
    }
    const std::size_t width = numbers[0] == 1 ? 2 : 4;
    file.read(bytes.subspan(2, width), "the array header's length");
    std::size_t length = 0;
    for (std::size_t i = 0; i < width; ++i) {
        length |= static_cast<std::size_t>(numbers[2 + i]) << (8 * i);
    }
    if (length > max_header_bytes) {
        cannot_read(file.path(),
                    fmt::format("array header of {} bytes, allowed: {}", length, max_header_bytes));
    }
    const std::string text = file.text(length, "the array header");
    try {
        return DictionaryParser(text).header();
    } catch (const std::runtime_error& error) {
        cannot_read(file.path(), error.what());
    }
}

}  // namespace hertzline::recordings
