#pragma once
// The journal of a study: a SQLite file with the identity of the study and the rows of finished points.
//
//     about(text)                                           JSON: study.hpp
//     points(point, a column for each of the table, samples)   NULL: no number; samples: float32, little-endian
//
// Any tool may read it while it grows:
//
//     sqlite3 -cmd '.timeout 1000' s.h5.journal 'SELECT "chain.preload_n", thd_r FROM points'
//
// The file is consistent at any time: a killed program loses only rows that it has not committed. It uses SQLite's rollback journal. A
// write-ahead log is faster, but needs memory that its users share, and parts of a sweep lie on file systems of clusters. A transaction
// for writing is always open: others can read, and other studies are kept out.

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "recordings/formats/table.hpp"
#include "studies/point.hpp"

namespace hertzline::studies {

class Database;
class Statement;

/// Errors are std::runtime_error that names path and reason. For one thread at a time.
class Journal {
public:
    enum class Use { begin, resume, read };

    /// begin: a new one, without rows; resume: an existing or a new one; read: an existing one, for merging.
    Journal(const std::filesystem::path& path, Use use);
    /// Makes one without a file, for rows that stay in this process.
    static Journal in_memory();
    ~Journal();
    Journal(Journal&& other) noexcept;
    Journal& operator=(Journal&&) = delete;
    Journal(const Journal&) = delete;
    Journal& operator=(const Journal&) = delete;

    bool is_in_memory() const noexcept;
    /// Whether begin() has yet to be called.
    bool is_new() const noexcept { return text_.empty(); }
    /// The identity of its study.
    const std::string& text() const noexcept { return text_; }
    const std::filesystem::path& path() const noexcept;

    /// Writes the identity and creates the table of rows; commit() puts them into the file. @param columns of the table, `point` first
    void begin(const std::string& text, std::span<const recordings::TableColumn> columns);

    /// Reads which points have rows. @param columns those of begin() @param samples in a row @param points of the study
    /// @throws std::runtime_error when it has rows of other points
    void load(std::span<const recordings::TableColumn> columns, std::size_t samples, std::int64_t points);

    /// Whether any row is committed.
    bool has_rows() const noexcept { return committed_ > 0; }

    /// Whether a point has a row. A resumed study runs points with status `failed` again.
    bool has(std::int64_t point) const noexcept { return statuses_[static_cast<std::size_t>(point)] != none; }
    PointStatus status(std::int64_t point) const noexcept {
        return static_cast<PointStatus>(statuses_[static_cast<std::size_t>(point)]);
    }

    /// Adds a row, or replaces the row of the same point; commit() puts it into the file.
    void append(PointStatus status, const recordings::TableRow& row);

    /// Commits the rows, unless the last commit was a moment ago or another program is reading the file.
    void commit_when_due();
    /// Commits the rows, and waits for readers of the file. @throws std::runtime_error also when they take a minute
    void commit();

    /// Reads the row of a point that has one.
    void read(std::int64_t point, recordings::TableRow& row) const;

    /// Removes the file.
    void remove() noexcept;
    /// Removes the file once the disk has the files that were written from it. @throws std::runtime_error when it has not; the journal
    /// stays
    void replace_by(std::span<const std::string> files);

    /// Returns an upper bound of a journal's size, without its identity [bytes].
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
    std::int64_t waiting_ = 0;            // rows to be committed
    std::int64_t committed_ = 0;
    Clock::time_point last_commit_;  // of rows: the first rows are committed at once
};

}  // namespace hertzline::studies
