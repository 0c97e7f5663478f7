#pragma once
// A SQLite file: statements, and errors that name the path and the reason.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>

struct sqlite3;
struct sqlite3_stmt;

namespace hertzline::studies {

class Database;

/// A prepared statement. Parameters and columns are counted from 0.
class Statement {
public:
    Statement() = default;
    /// @param database outlives this
    Statement(const Database& database, const std::string& sql);

    Statement& bind(int parameter, std::int64_t number);
    /// A NaN becomes NULL.
    Statement& bind(int parameter, double number);
    /// Texts and bytes outlive the next reset().
    Statement& bind(int parameter, std::string_view text);
    Statement& bind(int parameter, std::span<const std::byte> bytes);

    /// Advances to the next row. @returns whether there is one
    bool step();
    /// Ends the statement, ready for other parameters.
    void reset() noexcept;
    /// Runs a statement without rows, from its beginning to its end.
    void run();

    bool is_null(int column) const noexcept;
    bool is_integer(int column) const noexcept;
    bool is_number(int column) const noexcept;  ///< an integer, too
    bool is_text(int column) const noexcept;
    std::int64_t integer(int column) const noexcept;
    double number(int column) const noexcept;
    /// Valid until the next step() or reset().
    std::string_view text(int column) const noexcept;
    std::span<const std::byte> bytes(int column) const noexcept;

private:
    struct Finalize {
        void operator()(sqlite3_stmt* statement) const noexcept;
    };
    void require(int code) const;

    const Database* database_ = nullptr;
    std::unique_ptr<sqlite3_stmt, Finalize> statement_;
};

/// Errors are std::runtime_error that names path and reason.
class Database {
public:
    enum class Use { write, read };

    /// Opens a file; with Use::write creates it where it is missing.
    Database(std::filesystem::path path, Use use);
    /// Makes one in memory, without a name.
    Database();
    ~Database();
    Database(const Database&) = delete;
    Database& operator=(const Database&) = delete;

    const std::filesystem::path& path() const noexcept { return path_; }

    /// Runs statements without rows.
    void run(const std::string& sql) const;
    /// Runs a statement, unless another process locks the file. @returns whether it ran
    bool try_run(const std::string& sql) const;
    /// Returns the number that a query gives.
    std::int64_t number(const std::string& sql) const;

    /// Sets the time that statements wait for another process.
    void wait_for_others(int milliseconds) const noexcept;

    /// Whether a transaction is open; SQLite rolls it back after some errors.
    bool in_transaction() const noexcept;

    /// @throws std::runtime_error with the reason of SQLite's code
    [[noreturn]] void fail(int code) const;

private:
    friend class Statement;
    struct Close {
        void operator()(sqlite3* database) const noexcept;
    };

    std::filesystem::path path_;
    Use use_ = Use::write;
    std::unique_ptr<sqlite3, Close> database_;
};

/// Returns "name" for SQL, with its quotes doubled.
std::string quoted_name(std::string_view name);

}  // namespace hertzline::studies
