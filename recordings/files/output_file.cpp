#include "recordings/files/output_file.hpp"

#include <algorithm>
#include <cassert>
#include <cerrno>
#include <utility>

#include <sys/stat.h>
#include <unistd.h>

#include "recordings/files/staged_file.hpp"

namespace hertzline::recordings {

OutputFile::OutputFile(std::filesystem::path path, StagedFile::Devices devices, std::size_t record_bytes)
    : file_(std::move(path), devices), record_bytes_(record_bytes) {
    constexpr std::size_t about = std::size_t{1} << 20;
    buffer_bytes_ = std::max(std::size_t{1}, about / record_bytes) * record_bytes;
    buffer_.reserve(buffer_bytes_);
}

void OutputFile::write(std::string_view text) {
    write(std::as_bytes(std::span(text)));
}

void OutputFile::write(std::span<const std::byte> bytes) {
    file_.require_open();
    bytes_ += bytes.size();
    while (!bytes.empty()) {
        const auto part = bytes.first(std::min(bytes.size(), buffer_bytes_ - buffer_.size()));
        buffer_.insert(buffer_.end(), part.begin(), part.end());
        bytes = bytes.subspan(part.size());
        if (buffer_.size() == buffer_bytes_) {
            flush();
        }
    }
}

void OutputFile::rewrite(std::uint64_t offset, std::string_view text) {
    file_.require_open();
    assert(offset + text.size() <= bytes_);
    flush();
    if (const int error = write_all_at(file_.descriptor(), std::as_bytes(std::span(text)), offset)) {
        file_.fail(error);
    }
}

void OutputFile::flush() {
    file_.require_open();  // a failed write has written a part of the buffer
    if (const int error = write_all(file_.descriptor(), buffer_)) {
        if (const std::uint64_t odd = size() % record_bytes_; odd > 0) {
            // Where even this fails readers pass over the odd bytes.
            [[maybe_unused]] const int cut =
                ::ftruncate(file_.descriptor(), static_cast<off_t>(size() - odd));
        }
        file_.fail(error);
    }
    buffer_.clear();
}

bool OutputFile::fits(std::size_t bytes) const noexcept {
    return buffer_.size() + bytes < buffer_bytes_;
}

std::uint64_t OutputFile::size() const noexcept {
    struct stat status {};
    const bool is_there = ::fstat(file_.descriptor(), &status) == 0 && status.st_nlink > 0;
    return is_there ? static_cast<std::uint64_t>(status.st_size) : 0;
}

std::string OutputFile::text_from(std::uint64_t offset) const {
    std::string text(size() - std::min(size(), offset), '\0');
    const ssize_t got = ::pread(file_.descriptor(), text.data(), text.size(), static_cast<off_t>(offset));
    text.resize(static_cast<std::size_t>(std::max<ssize_t>(0, got)));
    return text;
}

void OutputFile::resume_at(std::uint64_t size) {
    buffer_.clear();
    bytes_ = size;
    file_.resume();
    const auto end = static_cast<off_t>(size);
    if (::ftruncate(file_.descriptor(), end) != 0 || ::lseek(file_.descriptor(), end, SEEK_SET) != end) {
        file_.fail(errno);
    }
}

std::filesystem::path OutputFile::keep() noexcept {
    file_.keep();
    return file_.temporary();
}

void OutputFile::require_present() {
    file_.require_open();
    struct stat status {};
    if (::fstat(file_.descriptor(), &status) == 0 && status.st_nlink == 0) {
        file_.fail(ENOENT);
    }
}

void OutputFile::close() {
    file_.require_open();  // fails when an earlier write did
    flush();
    file_.close();
}

void OutputFile::commit() {
    if (!file_.is_closed()) {
        close();
    }
    file_.commit();
}

}  // namespace hertzline::recordings
