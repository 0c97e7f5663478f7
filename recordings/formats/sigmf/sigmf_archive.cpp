#include "recordings/formats/sigmf/sigmf_archive.hpp"

#include <algorithm>
#include <charconv>
#include <string_view>
#include <utility>

#include <fmt/format.h>

namespace hertzline::recordings {

namespace {

constexpr std::uint64_t block = 512;
constexpr std::uint64_t not_told = ~std::uint64_t{0};  // in a header of its own
constexpr std::size_t max_files = 10'000;
constexpr std::uint64_t max_extension = 1 << 20;  // a long name, or attributes

std::string_view up_to_nul(std::string_view field) {
    return field.substr(0, field.find('\0'));
}

/// Returns a size in octal digits, or binary beyond 8 GiB; nothing when it is neither.
std::optional<std::uint64_t> size_in(std::string_view field) {
    std::uint64_t size = 0;
    if ((static_cast<unsigned char>(field.front()) & 0x80) != 0) {
        for (const char c : field.substr(4)) {
            size = size << 8 | static_cast<unsigned char>(c);
        }
        return size;
    }
    const std::string_view digits = field.substr(std::min(field.find_first_not_of(' '), field.size()));
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), size, 8);
    return error == std::errc() ? std::optional(size) : std::nullopt;
}

/// Whether the sum in a header is that of its bytes.
bool has_its_sum(std::string_view header) {
    std::uint64_t sum = 0;
    for (std::size_t i = 0; i < header.size(); ++i) {
        sum += i >= 148 && i < 156 ? ' ' : static_cast<unsigned char>(header[i]);
    }
    return size_in(header.substr(148, 8)) == sum;
}

/// Takes "27 path=...\n" lines of POSIX.1-2001.
void take_attributes(std::string_view text, std::string& name, std::uint64_t& size) {
    while (!text.empty()) {
        std::size_t length = 0;
        std::from_chars(text.data(), text.data() + text.size(), length);
        const std::size_t blank = text.find(' ');
        if (blank == std::string_view::npos || length <= blank + 1 || length > text.size()) {
            return;
        }
        const std::string_view line = text.substr(blank + 1, length - blank - 2);
        if (line.starts_with("path=")) {
            name = line.substr(5);
        } else if (line.starts_with("size=")) {
            std::uint64_t bytes = 0;
            std::from_chars(line.data() + 5, line.data() + line.size(), bytes);
            size = bytes;
        }
        text.remove_prefix(length);
    }
}

}  // namespace

std::vector<ArchivedFile> files_of_tar(InputFile& tar) {
    std::vector<ArchivedFile> files;
    std::string long_name;
    std::uint64_t long_size = not_told;
    while (tar.left() >= block) {
        const std::uint64_t at = tar.size() - tar.left();
        const std::string header = tar.text(block, "a header of the archive");
        if (header.find_first_not_of('\0') == std::string::npos) {
            break;
        }
        const auto told = size_in(std::string_view(header).substr(124, 12));
        if (!told || !has_its_sum(header) || files.size() == max_files) {
            cannot_read(tar.path(),
                        fmt::format("not an archive (an uncompressed tar), or damaged, at byte {}", at));
        }
        const std::uint64_t size = long_size == not_told ? *told : long_size;
        const std::uint64_t begin = at + block;
        if (size > tar.left()) {
            cannot_read(tar.path(),
                        fmt::format("cut short: a file of {} bytes at byte {}, the archive ends at {}", size,
                                    begin, tar.size()));
        }
        const char kind = header[156];
        if ((kind == 'x' || kind == 'L') && size <= max_extension) {
            const std::string text = tar.text(size, "a long name");
            if (kind == 'L') {
                long_name = up_to_nul(text);
            } else {
                take_attributes(text, long_name, long_size);
            }
        } else {
            std::string name = long_name.empty()
                                   ? std::string(up_to_nul(std::string_view(header).substr(0, 100)))
                                   : long_name;
            if (kind == '0' || kind == '\0' || kind == '7') {
                files.push_back({name.substr(name.find_last_of('/') + 1), begin, size});
            }
            long_name.clear();
            long_size = not_told;
        }
        tar.seek(begin + (size + block - 1) / block * block);
    }
    return files;
}

}  // namespace hertzline::recordings
