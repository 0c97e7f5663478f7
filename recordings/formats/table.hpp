#pragma once
// Typed columns that are no samples in time, such as spectra and the points of a sweep, in a file. Its ending picks the format:
//
//     .csv   a line of column names, then a line for each row; units and provenance lie beside it, as of a recording
//     .npy   two arrays: structured with a field for each column, then text, JSON: columns with units, provenance; numbers alone
//     .h5    attributes "columns" and "provenance" of the root, and a dataset for each column, called as its quantity, with its "units";
//            or, of a table of records, one compound dataset whose "units" has a text for each column, and the samples beside it
//
// The files have the same bytes whenever they are written.

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "core/scene/json.hpp"
#include "recordings/recording.hpp"

namespace hertzline::recordings {

/// Order of Cell's alternatives.
enum class CellKind { integer, number, text };
/// An integer, a number (NaN: none) or a text.
using Cell = std::variant<std::int64_t, double, std::string>;

struct TableColumn {
    Column about;
    CellKind kind = CellKind::number;
    std::size_t bytes = sizeof(double);  ///< a cell's, in HDF5; a longer text is cut
};

/// A row of float32 samples for each row of a table.
struct TableSamples {
    std::string name;
    std::string unit;
    std::size_t count = 0;     ///< in a row
    std::size_t channels = 1;  ///< numbers of each sample
};

struct TableRow {
    std::vector<Cell> cells;     ///< one for each column, of its kind
    std::vector<float> samples;  ///< empty where the table has none
};

struct Table {
    std::vector<TableColumn> columns;  ///< at least one; the first is the abscissa
    std::int64_t rows = 0;
    Json provenance;
    std::string records;  ///< name of the dataset that holds all columns; empty: a dataset for each
    std::optional<TableSamples> samples;  ///< in HDF5 files of records
    /// Fills in a row, whose cells keep their kinds from call to call. Rows may be asked for several times, each time in order.
    std::function<void(std::int64_t row, TableRow& into)> read;
};

/// Makes a table of numbers. @param values of each column, all as long
Table number_table(const std::vector<Column>& columns, std::vector<std::vector<double>> values,
                   Json provenance);

/// Returns all endings of tables: ".csv, .npy, .h5". @param table text needs .csv or .h5, samples need .h5
std::string table_endings(const Table& table = {});

/// Returns the fault of a name that has no ending for the table.
std::optional<std::string> table_fault(const std::filesystem::path& path, const Table& table = {});

/// Returns an upper bound of a table's bytes.
double table_bytes(const std::filesystem::path& path, std::span<const TableColumn> columns, double rows,
                   std::size_t samples = 0) noexcept;

/// Writes the table. The file has its name when it is complete. False, and nothing is left, once `stop` is true.
/// @throws std::runtime_error that names the path and the reason; then nothing is left, either
bool write_table(const std::filesystem::path& path, const Table& table, const std::atomic<bool>& stop);

/// A file of records that write_table() has written.
struct WrittenTable {
    std::vector<std::string> columns;  ///< names
    Json provenance;
};

/// Reads the names and the provenance of a table of records. @param records name of its dataset in HDF5
/// @throws std::runtime_error that names the path, when it is another file or damaged
WrittenTable read_table(const std::filesystem::path& path, const std::string& records);

/// Reads the rows of a table of records, without samples. @param columns those of the file
/// @throws std::runtime_error that names the path
std::vector<TableRow> read_table_rows(const std::filesystem::path& path, const std::string& records,
                                      std::span<const TableColumn> columns);

}  // namespace hertzline::recordings
