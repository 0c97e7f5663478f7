#include "studies/journal.hpp"

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cstring>
#include <optional>
#include <set>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <thread>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "core/scene/text.hpp"
#include "recordings/files/input_file.hpp"
#include "recordings/files/staged_file.hpp"
#include "studies/database.hpp"

namespace hertzline::studies {

namespace {

static_assert(std::endian::native == std::endian::little, "samples are written as they lie in memory");

using recordings::Cell;
using recordings::CellKind;
using recordings::TableColumn;
using recordings::TableRow;

constexpr int application = 0x485a534a;  // "HZSJ": marks journals among SQLite files
constexpr auto between_commits = std::chrono::milliseconds(100);
constexpr auto patience = std::chrono::minutes(1);
constexpr int a_moment_ms = 50;

/// Returns the SQL names of the table's columns and of the samples. SQLite ignores case: of two names that differ only in case, the
/// later one gets an underscore.
std::vector<std::string> names_in_sql(std::span<const TableColumn> columns) {
    std::vector<std::string> names;
    std::set<std::string> seen;
    const auto add = [&](std::string name) {
        while (!seen.insert(lower_case(name)).second) {
            name += '_';
        }
        names.push_back(quoted_name(name));
    };
    for (const TableColumn& column : columns) {
        add(column.about.name);
    }
    add("samples");
    return names;
}

/// Numbers have no declared type, because a column of type REAL stores -0.0 as the integer 0.
std::string create_points(std::span<const TableColumn> columns) {
    const std::vector<std::string> names = names_in_sql(columns);
    std::string sql = "CREATE TABLE points (" + names.front() + " INTEGER PRIMARY KEY";
    for (std::size_t i = 1; i < columns.size(); ++i) {
        sql += ", " + names[i] + (columns[i].kind == CellKind::text ? " TEXT" : "");
    }
    return sql + ", " + names.back() + " BLOB)";
}

void bind(Statement& statement, int parameter, const Cell& cell) {
    if (const auto* text = std::get_if<std::string>(&cell)) {
        statement.bind(parameter, std::string_view(*text));
    } else if (const auto* number = std::get_if<double>(&cell)) {
        statement.bind(parameter, *number);
    } else {
        statement.bind(parameter, std::get<std::int64_t>(cell));
    }
}

}  // namespace

Journal::Journal(std::unique_ptr<Database> database) : database_(std::move(database)) {}

Journal::Journal(const std::filesystem::path& path, Use use)
    : Journal(
          std::make_unique<Database>(path, use == Use::read ? Database::Use::read : Database::Use::write)) {
    if (use == Use::read) {
        database_->wait_for_others(1000);
        database_->run("BEGIN");  // all reads see one state
    } else {
        claim();
    }
    read_text(use);
}

Journal::~Journal() = default;
Journal::Journal(Journal&& other) noexcept = default;

Journal Journal::in_memory() {
    Journal journal(std::make_unique<Database>());
    journal.claim();
    return journal;
}

const std::filesystem::path& Journal::path() const noexcept {
    return database_->path();
}

bool Journal::is_in_memory() const noexcept {
    return path().empty();
}

/// Opens the transaction that keeps other studies out.
void Journal::claim() {
    database_->run("BEGIN IMMEDIATE");
    database_->wait_for_others(a_moment_ms);
    database_->run("PRAGMA cache_spill=OFF");  // it would lock readers out before a commit
}

void Journal::read_text(Use use) {
    const bool is_empty = database_->number("SELECT count(*) FROM sqlite_master") == 0;
    if (!is_empty && database_->number("PRAGMA application_id") != application) {
        recordings::cannot_read(path(), "it is no journal of a sweep or search");
    }
    if (is_empty && use == Use::read) {
        recordings::cannot_read(path(), "it is not complete");
    }
    if (is_empty) {
        return;
    }
    if (use == Use::begin) {
        if (database_->number("SELECT count(*) FROM (SELECT 1 FROM points LIMIT 1)") > 0) {
            throw std::runtime_error(
                printable_whole(path().string()) +
                " is the journal of an unfinished sweep or search, allowed: --resume to continue it, "
                "another -o FILE, or remove it");
        }
        return;  // nothing is lost
    }
    Statement query(*database_, "SELECT text FROM about");
    if (!query.step() || query.text(0).empty()) {
        recordings::cannot_read(path(), "it has no identity of a study");
    }
    text_ = query.text(0);
}

void Journal::begin(const std::string& text, std::span<const TableColumn> columns) {
    database_->run(
        fmt::format("PRAGMA application_id={}; DROP TABLE IF EXISTS about; DROP TABLE IF EXISTS points; "
                    "CREATE TABLE about (text TEXT)",
                    application));
    database_->run(create_points(columns));
    Statement(*database_, "INSERT INTO about VALUES (?)").bind(0, std::string_view(text)).run();
    text_ = text;
    text_waits_ = true;
}

void Journal::prepare(std::span<const TableColumn> columns, std::size_t samples) {
    kinds_.clear();
    std::ranges::transform(columns, std::back_inserter(kinds_), &TableColumn::kind);
    samples_ = samples;
    std::string names;
    std::string places;
    for (const std::string& name : names_in_sql(columns)) {
        names += (names.empty() ? "" : ", ") + name;
        places += places.empty() ? "?" : ", ?";
    }
    insert_ = std::make_unique<Statement>(
        *database_, fmt::format("INSERT OR REPLACE INTO points ({}) VALUES ({})", names, places));
    select_ = std::make_unique<Statement>(*database_, fmt::format("SELECT {} FROM points WHERE {} = ?", names,
                                                                  quoted_name(columns.front().about.name)));
}

void Journal::load(std::span<const TableColumn> columns, std::size_t samples, std::int64_t points) {
    prepare(columns, samples);
    statuses_.assign(static_cast<std::size_t>(points), none);
    committed_ = 0;
    if (text_waits_) {
        return;
    }
    Statement query(*database_, "SELECT point, status FROM points");
    while (query.step()) {
        const std::int64_t point = query.integer(0);
        const auto status = status_named(query.text(1));
        if (point < 0 || point >= points || !status) {
            recordings::cannot_read(
                path(), fmt::format("found a row of point {} with status \"{}\"", point, query.text(1)));
        }
        statuses_[static_cast<std::size_t>(point)] = static_cast<std::uint8_t>(*status);
        ++committed_;
    }
}

void Journal::append(PointStatus status, const TableRow& row) {
    const auto columns = static_cast<int>(row.cells.size());
    for (int i = 0; i < columns; ++i) {
        bind(*insert_, i, row.cells[static_cast<std::size_t>(i)]);
    }
    insert_->bind(columns, std::as_bytes(std::span(row.samples)));
    insert_->run();
    statuses_[static_cast<std::size_t>(std::get<std::int64_t>(row.cells.front()))] =
        static_cast<std::uint8_t>(status);
    ++waiting_;
}

/// The transaction stays open while another program reads, and is committed later.
bool Journal::try_commit() {
    if (!database_->in_transaction() || !database_->try_run("COMMIT")) {
        return false;
    }
    last_commit_ = waiting_ > 0 ? Clock::now() : last_commit_;
    committed_ += std::exchange(waiting_, 0);
    text_waits_ = false;
    database_->run("BEGIN IMMEDIATE");
    return true;
}

void Journal::commit_when_due() {
    if (waiting_ > 0 && Clock::now() - last_commit_ >= between_commits) {
        try_commit();
    }
}

void Journal::commit() {
    const auto asked = Clock::now();
    while ((waiting_ > 0 || text_waits_) && !try_commit()) {
        if (!database_->in_transaction()) {
            recordings::cannot_write(path(), "the rows since the last commit are lost");
        }
        if (Clock::now() - asked > patience) {
            recordings::cannot_write(path(), "another program has been reading it for a minute");
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(a_moment_ms));
    }
}

void Journal::read(std::int64_t point, TableRow& row) const {
    Statement& select = *select_;
    row.cells.resize(kinds_.size());
    select.bind(0, point);
    bool is_complete = select.step();
    for (int i = 0; is_complete && i < static_cast<int>(kinds_.size()); ++i) {
        Cell& cell = row.cells[static_cast<std::size_t>(i)];
        switch (kinds_[static_cast<std::size_t>(i)]) {
            case CellKind::integer:
                is_complete = select.is_integer(i);
                cell = select.integer(i);
                break;
            case CellKind::number:
                is_complete = select.is_number(i) || select.is_null(i);
                cell = select.number(i);
                break;
            case CellKind::text:
                is_complete = select.is_text(i);
                cell = std::string(select.text(i));
                break;
        }
    }
    if (is_complete) {
        const std::span<const std::byte> bytes = select.bytes(static_cast<int>(kinds_.size()));
        is_complete = bytes.size() == samples_ * sizeof(float);
        row.samples.resize(samples_);
        if (is_complete && samples_ > 0) {  // SQLite has no address for an empty blob
            std::memcpy(row.samples.data(), bytes.data(), bytes.size());
        }
    }
    select.reset();
    if (!is_complete) {
        recordings::cannot_read(path(), fmt::format("the row of point {} is damaged", point));
    }
}

void Journal::remove() noexcept {
    if (is_in_memory()) {
        return;
    }
    std::error_code gone;
    std::filesystem::remove(path(), gone);
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
            throw std::system_error(reason, std::generic_category(),
                                    fmt::format("cannot write {} to the disk, so {} is kept", file,
                                                printable_whole(path().string())));
        }
    }
    remove();
}

double Journal::bytes(double rows, std::span<const TableColumn> columns, std::size_t samples) noexcept {
    constexpr double row_bytes = 40;
    constexpr double head_bytes = 1;  // of a cell
    double bytes = row_bytes + static_cast<double>(samples * sizeof(float));
    for (const TableColumn& column : columns) {
        bytes += head_bytes + static_cast<double>(column.bytes);
    }
    return rows * bytes;
}

}  // namespace hertzline::studies
