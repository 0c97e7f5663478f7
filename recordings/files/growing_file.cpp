#include "recordings/files/growing_file.hpp"

#include <algorithm>
#include <cerrno>
#include <utility>

#include "recordings/files/write_all.hpp"
#include <sys/stat.h>
#include <unistd.h>

namespace hertzline::recordings {

GrowingFile::GrowingFile(std::filesystem::path path, std::size_t record_bytes)
    : file_(std::move(path), StagedFile::Devices::refused), record_bytes_(record_bytes) {
    constexpr std::size_t buffer_bytes = std::size_t{1} << 20;
    max_buffered_ = std::max(std::size_t{1}, buffer_bytes / record_bytes) * record_bytes;
    buffer_.reserve(max_buffered_);
}

void GrowingFile::write(std::span<const std::byte> records) {
    while (!records.empty()) {
        const auto part = records.first(std::min(records.size(), max_buffered_ - buffer_.size()));
        buffer_.insert(buffer_.end(), part.begin(), part.end());
        records = records.subspan(part.size());
        if (buffer_.size() == max_buffered_) {
            flush();
        }
    }
}

void GrowingFile::require_present() {
    file_.require_open();
    struct stat now {};
    if (::fstat(file_.descriptor(), &now) == 0 && now.st_nlink == 0) {
        file_.fail(ENOENT);
    }
}

std::int64_t GrowingFile::records() const noexcept {
    struct stat now {};
    const bool known = ::fstat(file_.descriptor(), &now) == 0 && now.st_nlink > 0;
    return known ? now.st_size / static_cast<off_t>(record_bytes_) : 0;
}

std::filesystem::path GrowingFile::keep() noexcept {
    file_.keep();
    return file_.temporary();
}

void GrowingFile::flush() {
    require_present();
    if (const int error = write_all(file_.descriptor(), buffer_)) {
        fail(error);
    }
    buffer_.clear();
}

/// The file ends with the last record that is whole.
void GrowingFile::fail(int reason) {
    struct stat now {};
    if (::fstat(file_.descriptor(), &now) == 0) {
        const auto record = static_cast<off_t>(record_bytes_);
        // Where even this fails readers pass over the odd bytes.
        [[maybe_unused]] const int cut = ::ftruncate(file_.descriptor(), now.st_size / record * record);
    }
    file_.fail(reason);
}

void GrowingFile::close() {
    flush();
    file_.close();
}

void GrowingFile::commit() {
    if (!file_.is_closed()) {
        close();
    }
    file_.commit();
}

}  // namespace hertzline::recordings
