#include "recordings/formats/table.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <memory>
#include <span>
#include <stdexcept>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "core/scene/faults.hpp"
#include "core/scene/json.hpp"
#include "core/scene/text.hpp"
#include "recordings/files/input_file.hpp"
#include "recordings/files/output_file.hpp"
#include "recordings/formats/csv/csv.hpp"
#include "recordings/formats/hdf5/hdf5.hpp"
#include "recordings/formats/npy_header.hpp"
#include "recordings/recording_formats.hpp"
#include "recordings/recording_head.hpp"

namespace hertzline::recordings {

namespace {

namespace fs = std::filesystem;

static_assert(std::endian::native == std::endian::little, "numbers are written as they lie in memory");

std::string metadata_text(const fs::path& path, const Table& table) {
    constexpr std::array datatypes{"integer", "double", "string"};  // in the order of CellKind
    std::vector<CsvColumn> columns;
    for (const TableColumn& column : table.columns) {
        columns.push_back({column.about, datatypes[static_cast<std::size_t>(column.kind)]});
    }
    return csv_metadata(path, columns, table.provenance);
}

/// Quoted as RFC 4180 has it.
void append_text(std::string& line, const std::string& text) {
    if (text.find_first_of(",\"\r\n") == std::string::npos) {
        line += text;
        return;
    }
    line += '"';
    for (const char c : text) {
        line += c == '"' ? "\"\"" : std::string(1, c);
    }
    line += '"';
}

void append_cell(std::string& line, const Cell& cell) {
    if (const auto* text = std::get_if<std::string>(&cell)) {
        append_text(line, *text);
    } else if (const auto* number = std::get_if<double>(&cell)) {
        if (std::isfinite(*number)) {
            append_csv_number(line, *number);
        } else {
            line += "nan";
        }
    } else {
        line += number_text(std::get<std::int64_t>(cell));
    }
}

bool write_csv(const fs::path& path, const Table& table, const std::atomic<bool>& stop) {
    OutputFile file(path, StagedFile::Devices::refused);
    OutputFile metadata(csv_metadata_path(path), StagedFile::Devices::refused);
    std::string line;
    for (const TableColumn& column : table.columns) {
        line += (line.empty() ? "" : ",") + column.about.name;
    }
    file.write(line + '\n');
    TableRow here;
    for (std::int64_t row = 0; row < table.rows; ++row) {
        if (stop.load(std::memory_order_relaxed)) {
            return false;
        }
        table.read(row, here);
        line.clear();
        for (const Cell& cell : here.cells) {
            line += line.empty() ? "" : ",";
            append_cell(line, cell);
        }
        file.write(line + '\n');
    }
    metadata.write(metadata_text(path, table));
    commit_csv(file, metadata, path);
    return true;
}

bool write_npy(const fs::path& path, const Table& table, const std::atomic<bool>& stop) {
    OutputFile file(path, StagedFile::Devices::refused);
    std::vector<NpyField> fields;
    for (const TableColumn& column : table.columns) {
        fields.push_back({column.about.name, column.kind == CellKind::integer ? "<i8" : "<f8"});
    }
    file.write(npy_header({fields, {static_cast<std::size_t>(table.rows)}}));
    TableRow here;
    for (std::int64_t row = 0; row < table.rows; ++row) {
        if (stop.load(std::memory_order_relaxed)) {
            return false;
        }
        table.read(row, here);
        for (const Cell& cell : here.cells) {
            const auto* number = std::get_if<double>(&cell);
            file.write(number != nullptr ? std::as_bytes(std::span(number, 1))
                                         : std::as_bytes(std::span(&std::get<std::int64_t>(cell), 1)));
        }
    }
    const std::string text =
        ascii_json_text(Json{{"columns", table_columns_json(table)}, {"provenance", table.provenance}});
    file.write(npy_header({{{"", "|S" + std::to_string(text.size())}}, {}}) + text);
    file.commit();
    return true;
}

struct TableFormat {
    std::string_view ending;
    double bytes_per_number;  // from above
    bool holds_text;
    bool holds_samples;
    bool (*write)(const fs::path&, const Table&, const std::atomic<bool>&);
};

constexpr std::array formats{
    TableFormat{".csv", 25, true, false, write_csv},
    TableFormat{".npy", 8, false, false, write_npy},
    TableFormat{".h5", 8, true, true, write_hdf5_table},
};

bool holds(const TableFormat& format, const Table& table) {
    const bool has_text =
        std::ranges::find(table.columns, CellKind::text, &TableColumn::kind) != table.columns.end();
    return (format.holds_text || !has_text) && (format.holds_samples || !table.samples);
}

const TableFormat* format_of(const fs::path& path) {
    const std::string ending = recording_ending(path);
    const auto* const found = std::ranges::find(formats, ending, &TableFormat::ending);
    return found != formats.end() ? found : nullptr;
}

/// The cells of a CSV, as RFC 4180 quotes them.
class CsvCells {
public:
    explicit CsvCells(std::string_view text) : text_(text) {}

    bool at_end() const noexcept { return text_.empty(); }

    /// Reads the next cell. @returns whether the line goes on after it
    bool read(std::string& cell) {
        cell.clear();
        bool quoted = false;
        while (!text_.empty()) {
            const char c = text_.front();
            text_.remove_prefix(1);
            if (c == '"' && quoted && text_.starts_with('"')) {
                cell += c;
                text_.remove_prefix(1);
            } else if (c == '"') {
                quoted = !quoted;
            } else if (!quoted && (c == ',' || c == '\n')) {
                return c == ',';
            } else {
                cell += c;
            }
        }
        return false;
    }

private:
    std::string_view text_;
};

std::vector<std::string> csv_names(CsvCells& cells) {
    std::vector<std::string> names(1);
    while (cells.read(names.back())) {
        names.emplace_back();
    }
    return names;
}

template <class Number>
Number number_of(const std::string& text) {
    const auto number = parsed_number<Number>(text);
    if (!number) {
        throw std::runtime_error("found " + quoted_briefly(text) + ", allowed: a number");
    }
    return *number;
}

Cell cell_of(CellKind kind, std::string text) {
    switch (kind) {
        case CellKind::integer:
            return number_of<std::int64_t>(text);
        case CellKind::number:
            return text == "nan" ? std::numeric_limits<double>::quiet_NaN() : number_of<double>(text);
        case CellKind::text:
            break;
    }
    return text;
}

std::string text_of_file(const fs::path& path) {
    InputFile file(path);
    return file.text(file.size(), "the table");
}

WrittenTable read_csv(const fs::path& path) {
    const std::string text = text_of_file(path);
    CsvCells cells(text);
    return {
        csv_names(cells),
        OutsideJson(json_from_outside(text_of_file(csv_metadata_path(path)))).at("urn:hertzline:provenance")};
}

std::vector<TableRow> read_csv_rows(const fs::path& path, std::span<const TableColumn> columns) {
    const std::string text = text_of_file(path);
    CsvCells cells(text);
    csv_names(cells);
    std::vector<TableRow> rows;
    std::string cell;
    while (!cells.at_end()) {
        TableRow& row = rows.emplace_back();
        for (std::size_t column = 0; column < columns.size(); ++column) {
            const bool goes_on = cells.read(cell);
            if (goes_on != (column + 1 < columns.size())) {
                throw std::runtime_error(fmt::format("row {} has not {} cells", rows.size(), columns.size()));
            }
            row.cells.push_back(cell_of(columns[column].kind, cell));
        }
    }
    return rows;
}

/// @throws std::runtime_error that names the path, whatever the work throws
template <class Read>
auto reading_of(const fs::path& path, const Read& read) {
    try {
        return read();
    } catch (const std::exception& error) {
        cannot_read(path, error.what());
    }
}

}  // namespace

Json table_columns_json(const Table& table) {
    Json columns = Json::array();
    for (const TableColumn& column : table.columns) {
        columns.push_back(Json::array({column.about.name, column.about.quantity, column.about.unit}));
    }
    return columns;
}

Table number_table(const std::vector<Column>& columns, std::vector<std::vector<double>> values,
                   Json provenance) {
    Table table;
    for (const Column& column : columns) {
        table.columns.push_back({column});
    }
    table.rows = static_cast<std::int64_t>(values.front().size());
    table.provenance = std::move(provenance);
    table.read = [kept = std::make_shared<const std::vector<std::vector<double>>>(std::move(values))](
                     std::int64_t row, TableRow& into) {
        into.cells.resize(kept->size());
        std::ranges::transform(*kept, into.cells.begin(), [row](const std::vector<double>& column) {
            return column[static_cast<std::size_t>(row)];
        });
    };
    return table;
}

std::string table_endings(const Table& table) {
    std::string endings;
    for (const TableFormat& format : formats) {
        if (holds(format, table)) {
            endings += (endings.empty() ? "" : ", ") + std::string(format.ending);
        }
    }
    return endings;
}

std::optional<std::string> table_fault(const fs::path& path, const Table& table) {
    const TableFormat* const format = format_of(path);
    if (format != nullptr && holds(*format, table)) {
        return std::nullopt;
    }
    return fmt::format("{}: found the ending {}, allowed: {}{}", printable_whole(path.string()),
                       quoted_briefly(recording_ending(path)), table_endings(table),
                       table.samples ? ", which holds waveforms, too" : "");
}

double table_bytes(const fs::path& path, std::span<const TableColumn> columns, double rows,
                   std::size_t samples) noexcept {
    const TableFormat* const format = format_of(path);
    auto bytes = static_cast<double>(samples * sizeof(float));
    for (const TableColumn& column : columns) {
        bytes += column.kind == CellKind::text ? static_cast<double>(column.bytes) : format->bytes_per_number;
    }
    return rows * bytes;
}

bool write_table(const fs::path& path, const Table& table, const std::atomic<bool>& stop) {
    throw_if(table_fault(path, table));
    return format_of(path)->write(path, table, stop);
}

WrittenTable read_table(const fs::path& path, const std::string& records) {
    return reading_of(path, [&] {
        return recording_ending(path) == ".csv" ? read_csv(path) : read_hdf5_table(path, records);
    });
}

std::vector<TableRow> read_table_rows(const fs::path& path, const std::string& records,
                                      std::span<const TableColumn> columns) {
    return reading_of(path, [&] {
        return recording_ending(path) == ".csv" ? read_csv_rows(path, columns)
                                                : read_hdf5_table_rows(path, records, columns);
    });
}

}  // namespace hertzline::recordings
