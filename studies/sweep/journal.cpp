#include "studies/sweep/journal.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <utility>

#include "recordings/files/errors.hpp"
#include "recordings/files/write_all.hpp"
#include <boost/crc.hpp>
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

namespace hertzline::studies {

struct Journal::Head {
    std::array<char, 8> magic{};
    std::uint32_t text_bytes = 0;
    std::uint32_t payload_bytes = 0;
    std::uint32_t checksum = 0;
    std::uint32_t unused = 0;
};

namespace {

static_assert(std::endian::native == std::endian::little, "numbers are written as they lie in memory");

constexpr std::string_view magic = "HZSWEEP1";
constexpr std::uint32_t max_text_bytes = 1U << 30;
constexpr std::size_t max_payload_bytes = std::size_t{1} << 31;

struct RowHead {
    std::int64_t point = 0;
    PointStatus status = PointStatus::ok;
    std::uint32_t checksum = 0;
};

/// CRC-32 as of zlib.
template <class... Parts>
std::uint32_t checksum_of(const Parts&... parts) {
    boost::crc_32_type crc;
    (crc.process_bytes(parts.data(), parts.size_bytes()), ...);
    return crc.checksum();
}

template <class T>
std::span<const std::byte> bytes_of(const T& value) {
    return std::as_bytes(std::span(&value, 1));
}

std::uint32_t checksum_of_head(std::uint32_t text_bytes, std::uint32_t payload_bytes, std::string_view text) {
    return checksum_of(bytes_of(text_bytes), bytes_of(payload_bytes), std::as_bytes(std::span(text)));
}

std::uint32_t checksum_of_row(const RowHead& head, std::span<const std::byte> payload) {
    return checksum_of(bytes_of(head.point), bytes_of(head.status), payload);
}

/// Reads until the bytes are full or the file ends. @returns how many there were, or -errno
std::int64_t read_at(int descriptor, std::span<std::byte> bytes, std::uint64_t offset) {
    std::size_t done = 0;
    while (done < bytes.size()) {
        const ssize_t read =
            ::pread(descriptor, bytes.data() + done, bytes.size() - done, static_cast<off_t>(offset + done));
        if (read == 0) {
            break;
        }
        if (read > 0) {
            done += static_cast<std::size_t>(read);
        } else if (errno != EINTR) {
            return -errno;
        }
    }
    return static_cast<std::int64_t>(done);
}

/// Whether the path still leads to the open file: another sweep may have removed it meanwhile.
bool is_there(int descriptor, const std::filesystem::path& path) {
    struct stat open {};
    struct stat named {};
    return ::fstat(descriptor, &open) == 0 && ::stat(path.c_str(), &named) == 0 &&
           open.st_ino == named.st_ino && open.st_dev == named.st_dev;
}

}  // namespace

Journal::Journal(std::filesystem::path path, Use use) : path_(std::move(path)) {
    open(use);
    try {
        read_head(use);
    } catch (...) {
        ::close(descriptor_);
        throw;
    }
}

Journal::~Journal() {
    if (descriptor_ >= 0) {
        ::close(descriptor_);
    }
}

Journal Journal::passing() {
    std::string name = std::filesystem::temp_directory_path() / "hertzline-sweep-XXXXXX";
    const int descriptor = ::mkstemp(name.data());
    if (descriptor < 0) {
        throw std::system_error(errno, std::generic_category(), "cannot write " + name);
    }
    ::close(descriptor);
    Journal journal(name, Use::begin);
    std::filesystem::remove(name);
    return journal;
}

Journal::Journal(Journal&& other) noexcept
    : path_(std::move(other.path_)),
      descriptor_(std::exchange(other.descriptor_, -1)),
      text_(std::move(other.text_)),
      payload_bytes_(other.payload_bytes_),
      first_row_(other.first_row_),
      row_count_(other.row_count_),
      rows_(std::move(other.rows_)),
      statuses_(std::move(other.statuses_)),
      row_(std::move(other.row_)),
      damaged_(other.damaged_) {}

void Journal::fail(const char* what, int reason) const {
    throw std::system_error(reason, std::generic_category(),
                            fmt::format("cannot {} {}", what, path_.string()));
}

void Journal::open(Use use) {
    const bool reads = use == Use::read;
    const int flags =
        (reads ? O_RDONLY : O_RDWR | O_CREAT) | O_CLOEXEC | O_NONBLOCK;  // a FIFO shall not wait
    do {
        if (descriptor_ >= 0) {
            ::close(descriptor_);
        }
        descriptor_ = ::open(path_.c_str(), flags, 0666);
        struct stat status {};
        if (descriptor_ < 0 || ::fstat(descriptor_, &status) != 0) {
            fail(reads ? "read" : "write", errno);
        }
        if (!S_ISREG(status.st_mode)) {
            ::close(descriptor_);
            recordings::cannot_read(path_, "it is no file");
        }
        if (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
            const int reason = errno;
            ::close(descriptor_);
            if (reason == EWOULDBLOCK) {
                throw std::runtime_error(path_.string() + " is in use by another sweep or search");
            }
            fail("lock", reason);
        }
    } while (!is_there(descriptor_, path_));
}

/// Where the file is too short for its text, it was torn off before the first row.
void Journal::read_text(const Head& head) {
    struct stat status {};
    if (head.text_bytes > max_text_bytes || head.payload_bytes > max_payload_bytes ||
        ::fstat(descriptor_, &status) != 0 ||
        static_cast<std::uint64_t>(status.st_size) < sizeof(Head) + head.text_bytes) {
        return;
    }
    std::string text(head.text_bytes, '\0');
    const std::int64_t there = read_at(descriptor_, std::as_writable_bytes(std::span(text)), sizeof(Head));
    if (there != static_cast<std::int64_t>(text.size()) ||
        checksum_of_head(head.text_bytes, head.payload_bytes, text) != head.checksum) {
        recordings::cannot_read(path_, "its beginning is damaged; without it nobody knows what was swept");
    }
    text_ = std::move(text);
    payload_bytes_ = head.payload_bytes;
    first_row_ = sizeof(Head) + text_.size();
}

void Journal::read_head(Use use) {
    Head head;
    const std::int64_t there = read_at(descriptor_, std::as_writable_bytes(std::span(&head, 1)), 0);
    if (there < 0) {
        fail("read", static_cast<int>(-there));
    }
    const std::string_view begins(head.magic.data(),
                                  std::min<std::size_t>(magic.size(), static_cast<std::size_t>(there)));
    if (!magic.starts_with(begins)) {
        recordings::cannot_read(path_, "it is no journal of a sweep or search");
    }
    if (there == static_cast<std::int64_t>(sizeof(Head))) {
        read_text(head);
    }
    if (use == Use::read && is_new()) {
        recordings::cannot_read(path_, "it is not complete");
    }
    struct stat status {};
    const std::uint64_t one_row = first_row_ + sizeof(RowHead) + payload_bytes_;
    if (use != Use::begin || is_new() || ::fstat(descriptor_, &status) != 0) {
        return;
    }
    if (static_cast<std::uint64_t>(status.st_size) >= one_row) {
        throw std::runtime_error(
            path_.string() +
            " is the journal of a sweep or search that has not ended, allowed: --resume to go on "
            "with it, another -o FILE, or remove it");
    }
    text_.clear();  // nothing is lost
}

void Journal::begin(const std::string& text, std::size_t payload_bytes) {
    Head head{{}, static_cast<std::uint32_t>(text.size()), static_cast<std::uint32_t>(payload_bytes), 0, 0};
    if (text.size() > max_text_bytes || payload_bytes > max_payload_bytes) {
        recordings::cannot_write(path_, "the plan or a row is too long");
    }
    std::ranges::copy(magic, head.magic.begin());
    head.checksum = checksum_of_head(head.text_bytes, head.payload_bytes, text);
    std::vector<std::byte> bytes(sizeof(Head) + text.size());
    std::memcpy(bytes.data(), &head, sizeof(Head));
    std::memcpy(bytes.data() + sizeof(Head), text.data(), text.size());
    if (::ftruncate(descriptor_, 0) != 0) {
        fail("write", errno);
    }
    if (const int reason = recordings::write_all_at(descriptor_, bytes, 0); reason != 0) {
        const int removed = ::ftruncate(descriptor_, 0);
        (void)removed;
        fail("write", reason);
    }
    text_ = text;
    payload_bytes_ = payload_bytes;
    first_row_ = bytes.size();
}

void Journal::take_row(std::span<const std::byte> row, std::uint32_t number) {
    RowHead head;
    std::memcpy(&head, row.data(), sizeof(RowHead));
    const bool sound = head.point >= 0 && head.point < static_cast<std::int64_t>(rows_.size()) &&
                       head.status <= PointStatus::failed &&
                       checksum_of_row(head, row.subspan(sizeof(RowHead))) == head.checksum;
    if (!sound) {
        ++damaged_;
        return;
    }
    const auto point = static_cast<std::size_t>(head.point);
    rows_[point] = number;
    statuses_[point] = head.status;
}

void Journal::load(std::int64_t points) {
    rows_.assign(static_cast<std::size_t>(points), 0);
    statuses_.assign(static_cast<std::size_t>(points), PointStatus::ok);
    const std::size_t row_bytes = sizeof(RowHead) + payload_bytes_;
    row_count_ = 0;
    struct stat status {};
    if (::fstat(descriptor_, &status) != 0) {
        fail("read", errno);
    }
    if (static_cast<std::uint64_t>(status.st_size) < first_row_ + row_bytes) {
        return;  // a row may be a long waveform: no memory is taken for none
    }
    constexpr std::size_t portion = std::size_t{1} << 20;
    const std::size_t rows_at_once = std::max<std::size_t>(1, portion / row_bytes);
    std::vector<std::byte> rows(rows_at_once * row_bytes);
    while (true) {
        const std::int64_t there =
            read_at(descriptor_, rows, first_row_ + std::uint64_t{row_count_} * row_bytes);
        if (there < 0) {
            fail("read", static_cast<int>(-there));
        }
        const std::size_t whole = static_cast<std::size_t>(there) / row_bytes;
        for (std::size_t i = 0; i < whole; ++i) {
            take_row(std::span(rows).subspan(i * row_bytes, row_bytes), ++row_count_);
        }
        if (whole < rows_at_once) {
            return;  // a row that was torn off is overwritten by the next one
        }
    }
}

void Journal::append(std::int64_t point, PointStatus status, std::span<const std::byte> payload) {
    row_.resize(sizeof(RowHead) + payload.size());
    RowHead head{point, status, 0};
    head.checksum = checksum_of_row(head, payload);
    std::memcpy(row_.data(), &head, sizeof(RowHead));
    std::ranges::copy(payload, row_.begin() + sizeof(RowHead));
    const std::uint64_t at = first_row_ + std::uint64_t{row_count_} * row_.size();
    if (const int reason = recordings::write_all_at(descriptor_, row_, at); reason != 0) {
        fail("write", reason);
    }
    rows_[static_cast<std::size_t>(point)] = ++row_count_;
    statuses_[static_cast<std::size_t>(point)] = status;
}

void Journal::read(std::int64_t point, std::span<std::byte> payload) const {
    const std::uint64_t row = rows_[static_cast<std::size_t>(point)] - 1;
    const std::uint64_t at = first_row_ + row * (sizeof(RowHead) + payload_bytes_) + sizeof(RowHead);
    const std::int64_t there = read_at(descriptor_, payload, at);
    if (there != static_cast<std::int64_t>(payload.size())) {
        fail("read", there < 0 ? static_cast<int>(-there) : EIO);
    }
}

void Journal::sync() {
    if (::fdatasync(descriptor_) != 0) {
        fail("write", errno);
    }
}

void Journal::remove() noexcept {
    std::error_code gone;
    std::filesystem::remove(path_, gone);
}

void Journal::replace_by(std::span<const std::string> files) {
    for (const std::string& file : files) {
        const int written = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
        const bool there = written >= 0 && ::fsync(written) == 0;
        const int reason = errno;
        if (written >= 0) {
            ::close(written);
        }
        if (!there) {
            throw std::system_error(
                reason, std::generic_category(),
                fmt::format("cannot write {} to the disk, so {} is kept", file, path_.string()));
        }
    }
    remove();
}

double Journal::bytes(double rows, std::size_t payload_bytes) noexcept {
    return rows * static_cast<double>(sizeof(RowHead) + payload_bytes);
}

}  // namespace hertzline::studies
