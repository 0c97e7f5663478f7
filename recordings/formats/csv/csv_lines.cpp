#include "recordings/formats/csv/csv_lines.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/scene/text.hpp"
#include "recordings/files/input_file.hpp"

namespace hertzline::recordings {

namespace {

constexpr std::size_t longest_line = std::size_t{1} << 29;  // 20 million numbers, as of the longest chain

}  // namespace

// Without O_NONBLOCK open() would wait for a pipe's writer.
CsvLines::CsvLines(const std::filesystem::path& path, const std::atomic<bool>* stop)
    : path_(path),
      stop_(stop),
      descriptor_(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOCTTY | O_NONBLOCK)) {
    struct stat status {};
    const int error = descriptor_ < 0 || ::fstat(descriptor_, &status) != 0 ? errno : 0;
    if (error != 0 || S_ISDIR(status.st_mode)) {
        close();
        cannot_read(path, error != 0 ? std::generic_category().message(error) : "not a file");
    }
    is_pipe_ = !S_ISREG(status.st_mode);
}

CsvLines::~CsvLines() {
    close();
}

bool CsvLines::next() {
    begin_ = line_end_;
    for (std::size_t searched = begin_;;) {
        const std::size_t found = find_end(searched);
        if (found < end_) {
            take(found, 1);
            return true;
        }
        searched = end_ - begin_;
        std::memmove(buffer_.data(), buffer_.data() + begin_, searched);
        begin_ = line_size_ = line_end_ = 0;
        end_ = searched;
        if (!fill()) {
            const bool rest = !stopped() && end_ > 0;
            if (rest) {
                take(end_, 0);
            }
            return rest;
        }
    }
}

/// Returns the place of the line's end, end_ if it is not there yet. The first line shows how lines end.
std::size_t CsvLines::find_end(std::size_t from) {
    const std::string_view there(buffer_.data(), end_);
    if (ending_ == 0) {
        const std::size_t found = std::min(there.find_first_of("\r\n", begin_), end_);
        if (found + 1 >= end_ && !(found < end_ && there[found] == '\n')) {
            return end_;  // the byte behind a CR decides
        }
        ending_ = there[found] == '\r' && there[found + 1] != '\n' ? '\r' : '\n';
    }
    return std::min(there.find(ending_, from), end_);
}

void CsvLines::take(std::size_t end, std::size_t ending) {
    is_ended_ = ending > 0 || buffer_[end - 1] == '\r';
    line_size_ = end - begin_;
    line_end_ = end + ending;
    line_size_ -= line().ends_with('\r') ? 1 : 0;
    if (++number_ == 1) {
        pass_byte_order_mark();
    }
}

void CsvLines::pass_byte_order_mark() {
    constexpr std::string_view utf8 = "\xef\xbb\xbf";
    if (line().starts_with(utf8)) {
        begin_ += utf8.size();
        line_size_ -= utf8.size();
    }
}

void CsvLines::fail(const std::string& fault) const {
    throw std::runtime_error(fmt::format("{}: {}", name(), fault));
}

std::string CsvLines::name() const {
    return fmt::format("{}:{}", printable_whole(path_.string()), std::max<std::int64_t>(1, number_));
}

void CsvLines::go_back(const Place& place) {
    if (::lseek(descriptor_, place.byte, SEEK_SET) != place.byte) {
        cannot_read(path_, std::generic_category().message(errno));
    }
    read_ = place.byte;
    number_ = place.number;
    begin_ = line_end_ = line_size_ = end_ = 0;
}

/// Reads more behind the bytes that are there. Returns false at the end and once stopped.
bool CsvLines::fill() {
    if (end_ == buffer_.size()) {
        const bool too_long = end_ >= longest_line;
        if (too_long || std::memchr(buffer_.data(), 0, end_) != nullptr) {
            ++number_;
            fail(too_long ? "the line is too long" : "found a byte 0, allowed: text");
        }
        buffer_.resize(2 * end_);
    }
    while (!is_pipe_ || wait_for_writer()) {
        const ssize_t got = ::read(descriptor_, buffer_.data() + end_, buffer_.size() - end_);
        if (got < 0 && (errno == EINTR || errno == EAGAIN)) {
            continue;
        }
        if (got < 0) {
            cannot_read(path_, std::generic_category().message(errno));
        }
        end_ += static_cast<std::size_t>(got);
        read_ += got;
        const std::string_view begin(buffer_.data(), std::min<std::size_t>(2, end_));
        if (read_ == static_cast<std::int64_t>(end_) && (begin == "\xff\xfe" || begin == "\xfe\xff")) {
            cannot_read(path_, "text in UTF-16, allowed: UTF-8 (a spreadsheet's \"CSV UTF-8\")");
        }
        return got > 0;
    }
    return false;
}

/// Returns false once stopped.
bool CsvLines::wait_for_writer() const {
    while (!stopped()) {
        constexpr int glance_ms = 50;  // between looks at the flag
        pollfd pipe{.fd = descriptor_, .events = POLLIN, .revents = 0};
        if (::poll(&pipe, 1, glance_ms) > 0) {
            return true;
        }
    }
    return false;
}

void CsvLines::close() noexcept {
    if (descriptor_ >= 0) {
        ::close(std::exchange(descriptor_, -1));
    }
}

}  // namespace hertzline::recordings
