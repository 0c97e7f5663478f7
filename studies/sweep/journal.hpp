#pragma once
// The journal of a study: a SQLite file with a text that says what is studied, and the rows that are done.
//
//     about(text)                                           JSON: sweep.hpp
//     points(point, a column for each of the table, samples)   NULL: no number; samples: float32, little-endian
//
// Any tool may read it while it grows:
//
//     sqlite3 -cmd '.timeout 1000' s.h5.journal 'SELECT "chain.preload_n", thd_r FROM points'
//
// It is whole at any time: what a killed program has not committed is missing, and nothing else. It keeps SQLite's rollback journal. A
// write-ahead log is faster, but needs memory that all who have the file open share, and parts of a sweep lie on file systems of clusters.
// A transaction that may write is open all the time: it lets others read, and keeps other studies out.

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "recordings/formats/table.hpp"
#include "studies/sweep/point_result.hpp"

namespace hertzline::studies {

class Database;
class Statement;

/// Errors are std::runtime_error that names path and reason. For one thread at a time.
class Journal {
public:
    enum class Use { begin, resume, read };

    /// begin: there is none with rows yet; resume: goes on with one, or begins it; read: for merging, and must be there.
    Journal(const std::filesystem::path& path, Use use);
    /// One without a file: for rows that stay in this process.
    static Journal in_memory();
    ~Journal();
    Journal(Journal&& other) noexcept;
    Journal& operator=(Journal&&) = delete;
    Journal(const Journal&) = delete;
    Journal& operator=(const Journal&) = delete;

    bool is_in_memory() const noexcept;
    /// Nothing was written to it yet: begin() does.
    bool is_new() const noexcept { return text_.empty(); }
    /// What it says of the study.
    const std::string& text() const noexcept { return text_; }
    const std::filesystem::path& path() const noexcept;

    /// Writes the text, and makes room for rows; in the file once it is committed. @param columns of the table, `point` first
    void begin(const std::string& text, std::span<const recordings::TableColumn> columns);

    /// Looks for the rows of so many points. @param columns as it was begun with @param samples in a row
    /// @throws std::runtime_error when its rows are others
    void load(std::span<const recordings::TableColumn> columns, std::size_t samples, std::int64_t points);

    /// Some rows are in the file for good.
    bool has_rows() const noexcept { return committed_ > 0; }

    /// Whether there is a row. One that is `failed` is tried again where a study is resumed.
    bool has(std::int64_t point) const noexcept { return statuses_[static_cast<std::size_t>(point)] != none; }
    PointStatus status(std::int64_t point) const noexcept {
        return static_cast<PointStatus>(statuses_[static_cast<std::size_t>(point)]);
    }

    /// Adds a row, or replaces that of the same point. It is in the file once it is committed.
    void append(PointStatus status, const recordings::TableRow& row);

    /// Commits the rows, unless this was done a moment ago, or another program reads the file just now: then they wait for the next time.
    void commit_when_due();
    /// Commits the rows, and waits for who reads the file. @throws std::runtime_error also when that takes a minute
    void commit();

    /// Fills in the row of a point that it has.
    void read(std::int64_t point, recordings::TableRow& row) const;

    /// Removes the file.
    void remove() noexcept;
    /// The same once the disk has the files that were written from it. @throws std::runtime_error when it has not; the journal stays
    void replace_by(std::span<const std::string> files);

    /// Bytes of a journal with so many rows, from above, without its text.
    static double bytes(double rows, std::span<const recordings::TableColumn> columns,
                        std::size_t samples) noexcept;

private:
    static constexpr std::uint8_t none = 0xff;
    using Clock = std::chrono::steady_clock;

    explicit Journal(std::unique_ptr<Database> database);
    void claim();
    void read_text(Use use);
    void prepare(std::span<const recordings::TableColumn> columns, std::size_t samples);
    bool try_commit();

    std::unique_ptr<Database> database_;
    std::string text_;
    std::vector<recordings::CellKind> kinds_;  // of the columns
    std::size_t samples_ = 0;
    std::unique_ptr<Statement> insert_;
    std::unique_ptr<Statement> select_;
    std::vector<std::uint8_t> statuses_;  // of each point
    bool text_waits_ = false;             // to be committed
    std::int64_t waiting_ = 0;            // rows that are to be committed
    std::int64_t committed_ = 0;
    Clock::time_point last_commit_;  // of rows: the first ones are committed at once
};

}  // namespace hertzline::studies
