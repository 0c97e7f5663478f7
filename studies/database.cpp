#include "studies/database.hpp"

#include <limits>
#include <stdexcept>
#include <system_error>
#include <utility>

#include <sqlite3.h>

#include "core/scene/text.hpp"
#include "recordings/files/input_file.hpp"
#include "recordings/files/staged_file.hpp"

namespace hertzline::studies {

namespace {

constexpr int primary_code = 0xff;  // extended codes have more bits

void require_room(int code, const Database& database) {
    if (code != SQLITE_OK) {
        database.fail(code);
    }
}

}  // namespace

void Statement::Finalize::operator()(sqlite3_stmt* statement) const noexcept {
    sqlite3_finalize(statement);
}

Statement::Statement(const Database& database, const std::string& sql) : database_(&database) {
    sqlite3_stmt* statement = nullptr;
    require(sqlite3_prepare_v2(database.database_.get(), sql.c_str(), -1, &statement, nullptr));
    statement_.reset(statement);
}

void Statement::require(int code) const {
    require_room(code, *database_);
}

Statement& Statement::bind(int parameter, std::int64_t number) {
    require(sqlite3_bind_int64(statement_.get(), parameter + 1, number));
    return *this;
}

Statement& Statement::bind(int parameter, double number) {
    require(sqlite3_bind_double(statement_.get(), parameter + 1, number));
    return *this;
}

Statement& Statement::bind(int parameter, std::string_view text) {
    require(sqlite3_bind_text64(statement_.get(), parameter + 1, text.data(), text.size(), SQLITE_STATIC,
                                SQLITE_UTF8));
    return *this;
}

Statement& Statement::bind(int parameter, std::span<const std::byte> bytes) {
    require(sqlite3_bind_blob64(statement_.get(), parameter + 1, bytes.data(), bytes.size(), SQLITE_STATIC));
    return *this;
}

bool Statement::step() {
    const int code = sqlite3_step(statement_.get());
    if (code != SQLITE_ROW && code != SQLITE_DONE) {
        reset();
        database_->fail(code);
    }
    return code == SQLITE_ROW;
}

void Statement::reset() noexcept {
    sqlite3_reset(statement_.get());
}

void Statement::run() {
    step();
    reset();
}

bool Statement::is_null(int column) const noexcept {
    return sqlite3_column_type(statement_.get(), column) == SQLITE_NULL;
}

bool Statement::is_integer(int column) const noexcept {
    return sqlite3_column_type(statement_.get(), column) == SQLITE_INTEGER;
}

bool Statement::is_number(int column) const noexcept {
    return is_integer(column) || sqlite3_column_type(statement_.get(), column) == SQLITE_FLOAT;
}

bool Statement::is_text(int column) const noexcept {
    return sqlite3_column_type(statement_.get(), column) == SQLITE_TEXT;
}

std::int64_t Statement::integer(int column) const noexcept {
    return sqlite3_column_int64(statement_.get(), column);
}

double Statement::number(int column) const noexcept {
    return is_null(column) ? std::numeric_limits<double>::quiet_NaN()
                           : sqlite3_column_double(statement_.get(), column);
}

std::string_view Statement::text(int column) const noexcept {
    const auto* const text = reinterpret_cast<const char*>(sqlite3_column_text(statement_.get(), column));
    const auto size = static_cast<std::size_t>(sqlite3_column_bytes(statement_.get(), column));
    return text != nullptr ? std::string_view(text, size) : std::string_view();
}

std::span<const std::byte> Statement::bytes(int column) const noexcept {
    const auto* const bytes = static_cast<const std::byte*>(sqlite3_column_blob(statement_.get(), column));
    return {bytes, static_cast<std::size_t>(sqlite3_column_bytes(statement_.get(), column))};
}

void Database::Close::operator()(sqlite3* database) const noexcept {
    sqlite3_close_v2(database);  // after its last statement
}

Database::Database(std::filesystem::path path, Use use) : path_(std::move(path)), use_(use) {
    sqlite3* database = nullptr;
    const int flags = SQLITE_OPEN_READWRITE | (use == Use::write ? SQLITE_OPEN_CREATE : 0);
    const int code = sqlite3_open_v2(std::filesystem::absolute(path_).c_str(), &database, flags, nullptr);
    database_.reset(database);
    if (code != SQLITE_OK) {
        fail(code);
    }
    sqlite3_extended_result_codes(database, 1);
    sqlite3_db_config(database, SQLITE_DBCONFIG_DQS_DML, 0,
                      nullptr);  // an unknown column is an error, not a text
    run("PRAGMA trusted_schema=OFF");
}

Database::Database() {
    sqlite3* database = nullptr;
    const int code = sqlite3_open(":memory:", &database);
    database_.reset(database);
    if (code != SQLITE_OK) {
        fail(code);
    }
}

Database::~Database() = default;

void Database::fail(int code) const {
    const int primary = code & primary_code;
    std::string reason = sqlite3_errstr(primary);
    if (primary == SQLITE_BUSY) {
        throw std::runtime_error(printable_whole(path_.string()) + " is in use by another sweep or search");
    }
    if (primary == SQLITE_NOMEM) {
        throw std::bad_alloc();
    }
    if (primary == SQLITE_NOTADB) {
        recordings::cannot_read(path_, "it is no journal of a sweep or search");
    }
    if (primary == SQLITE_CORRUPT || primary == SQLITE_ERROR) {
        recordings::cannot_read(path_, database_ ? sqlite3_errmsg(database_.get()) : reason.c_str());
    }
    if (primary == SQLITE_FULL) {
        reason = std::generic_category().message(ENOSPC);
    } else if (primary == SQLITE_IOERR || primary == SQLITE_CANTOPEN) {
        int system = database_ ? sqlite3_system_errno(database_.get()) : 0;
        if (system == 0) {  // e.g. when a commit fails
            sqlite3_file_control(database_.get(), "main", SQLITE_FCNTL_LAST_ERRNO, &system);
        }
        reason = system != 0 ? std::generic_category().message(system) : reason;
    }
    if (use_ == Use::read || code == SQLITE_IOERR_READ) {
        recordings::cannot_read(path_, reason);
    }
    recordings::cannot_write(path_, reason);
}

void Database::run(const std::string& sql) const {
    require_room(sqlite3_exec(database_.get(), sql.c_str(), nullptr, nullptr, nullptr), *this);
}

bool Database::try_run(const std::string& sql) const {
    const int code = sqlite3_exec(database_.get(), sql.c_str(), nullptr, nullptr, nullptr);
    if (code != SQLITE_OK && (code & primary_code) != SQLITE_BUSY) {
        fail(code);
    }
    return code == SQLITE_OK;
}

std::int64_t Database::number(const std::string& sql) const {
    Statement query(*this, sql);
    return query.step() ? query.integer(0) : 0;
}

void Database::wait_for_others(int milliseconds) const noexcept {
    sqlite3_busy_timeout(database_.get(), milliseconds);
}

bool Database::in_transaction() const noexcept {
    return sqlite3_get_autocommit(database_.get()) == 0;
}

std::string quoted_name(std::string_view name) {
    std::string quoted = "\"";
    for (const char c : name) {
        quoted += c == '"' ? "\"\"" : std::string(1, c);
    }
    return quoted + '"';
}

}  // namespace hertzline::studies
