#include "recordings/files/output_file.hpp"

#include <algorithm>
#include <cassert>
#include <cerrno>
#include <utility>

#include "recordings/files/write_all.hpp"
#include <sys/stat.h>
#include <unistd.h>

namespace hertzline::recordings {
namespace {

constexpr std::size_t buffer_bytes = std::size_t{1} << 20;

}  // namespace

OutputFile::OutputFile(std::filesystem::path path, StagedFile::Devices devices)
    : file_(std::move(path), devices) {
    buffer_.reserve(buffer_bytes);
}

void OutputFile::write(std::string_view text) {
    write(std::as_bytes(std::span(text)));
}

void OutputFile::write(std::span<const std::byte> bytes) {
    file_.require_open();
    bytes_ += bytes.size();
    while (!bytes.empty()) {
        const auto part = bytes.first(std::min(bytes.size(), buffer_bytes - buffer_.size()));
        buffer_.insert(buffer_.end(), part.begin(), part.end());
        bytes = bytes.subspan(part.size());
        if (buffer_.size() == buffer_bytes) {
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
    if (const int error = write_all(file_.descriptor(), buffer_)) {
        file_.fail(error);
    }
    buffer_.clear();
}

bool OutputFile::fits(std::size_t bytes) const noexcept {
    return buffer_.size() + bytes < buffer_bytes;
}

std::uint64_t OutputFile::size() const noexcept {
    struct stat status {};
    return ::fstat(file_.descriptor(), &status) == 0 ? static_cast<std::uint64_t>(status.st_size) : 0;
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
