#pragma once
// The journal of a sweep: a text that tells what is swept, then rows of one size with checksums, in the order in which points finish.
// It is whole at any time: what a killed program has not written is missing, and nothing else.
//
//     "HZSWEEP1" | u32 bytes of the text | u32 bytes of a payload | u32 CRC-32 of these and the text | u32 0 | text
//     for each row: i64 point | u32 status | u32 CRC-32 of the row without it | payload          little-endian

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "studies/sweep/point_result.hpp"

namespace hertzline::studies {

/// A journal, locked against other sweeps as long as it is open. Errors are std::runtime_error that names path and reason.
/// append() may be called from one thread at a time.
class Journal {
public:
    enum class Use { begin, resume, read };

    /// begin: there is none with rows yet; resume: goes on with one, or begins it; read: for merging, and must be there.
    Journal(std::filesystem::path path, Use use);
    /// One without a name, in the folder for temporary files: for rows that stay in this process.
    static Journal passing();
    ~Journal();
    Journal(Journal&& other) noexcept;
    Journal& operator=(Journal&&) = delete;
    Journal(const Journal&) = delete;
    Journal& operator=(const Journal&) = delete;

    /// Nothing was written to it yet: begin() does.
    bool is_new() const noexcept { return text_.empty(); }
    /// What it says of the sweep.
    const std::string& text() const noexcept { return text_; }
    const std::filesystem::path& path() const noexcept { return path_; }

    /// Writes the text. @param payload_bytes of a row
    void begin(const std::string& text, std::size_t payload_bytes);

    /// Looks for the rows of so many points. A row that was torn off is overwritten by the next one.
    void load(std::int64_t points);

    bool has_rows() const noexcept { return row_count_ > 0; }

    /// Rows that were found damaged: they are as if they were not there.
    std::int64_t damaged() const noexcept { return damaged_; }

    /// Whether there is a row. One that is `failed` is tried again where a sweep is resumed.
    bool has(std::int64_t point) const noexcept { return rows_[static_cast<std::size_t>(point)] != 0; }
    PointStatus status(std::int64_t point) const noexcept {
        return statuses_[static_cast<std::size_t>(point)];
    }

    /// Adds a row; one of the same point counts no more.
    void append(std::int64_t point, PointStatus status, std::span<const std::byte> payload);

    /// The payload of a point that it has.
    void read(std::int64_t point, std::span<std::byte> payload) const;

    std::size_t payload_bytes() const noexcept { return payload_bytes_; }

    /// Waits until the disk has what was appended.
    void sync();

    /// Removes the file.
    void remove() noexcept;
    /// The same once the disk has the files that were written from it. @throws std::runtime_error when it has not; the journal stays
    void replace_by(std::span<const std::string> files);

    /// Bytes of a journal with so many rows, without its text.
    static double bytes(double rows, std::size_t payload_bytes) noexcept;

private:
    void open(Use use);
    struct Head;
    void read_head(Use use);
    void read_text(const Head& head);
    void take_row(std::span<const std::byte> row, std::uint32_t number);
    [[noreturn]] void fail(const char* what, int reason) const;

    std::filesystem::path path_;
    int descriptor_ = -1;
    std::string text_;
    std::size_t payload_bytes_ = 0;
    std::uint64_t first_row_ = 0;  // where rows begin in the file
    std::uint32_t row_count_ = 0;
    std::vector<std::uint32_t> rows_;  // of each point: number of its row from 1, 0: none
    std::vector<PointStatus> statuses_;
    std::vector<std::byte> row_;  // that is appended
    std::int64_t damaged_ = 0;
};

}  // namespace hertzline::studies
