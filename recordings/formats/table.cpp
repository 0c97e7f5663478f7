#include "recordings/formats/table.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <span>
#include <stdexcept>
#include <string_view>

#include "recordings/files/output_file.hpp"
#include "recordings/formats/csv.hpp"
#include "recordings/formats/csv_metadata.hpp"
#include "recordings/formats/hdf5/hdf5.hpp"
#include "recordings/formats/npy_header.hpp"
#include "recordings/recording_formats.hpp"
#include "recordings/recording_head.hpp"
#include <fmt/format.h>

#include "core/scene/json.hpp"

namespace hertzline::recordings {

namespace {

namespace fs = std::filesystem;

static_assert(std::endian::native == std::endian::little, "numbers are written as they lie in memory");

constexpr std::size_t rows_between_looks = 1 << 12;  // at the stop flag

bool stopped(std::size_t row, const std::atomic<bool>& stop) noexcept {
    return row % rows_between_looks == 0 && stop.load(std::memory_order_relaxed);
}

std::string metadata_text(const fs::path& path, const Table& table) {
    std::vector<CsvColumn> columns;
    for (const TableColumn& column : table.columns) {
        columns.push_back({column.about, "double"});
    }
    return csv_metadata(path, columns, table.provenance);
}

bool write_csv(const fs::path& path, const Table& table, const std::atomic<bool>& stop) {
    OutputFile file(path, StagedFile::Devices::refused);
    OutputFile metadata(csv_metadata_path(path), StagedFile::Devices::refused);
    std::string line;
    for (const TableColumn& column : table.columns) {
        line += (line.empty() ? "" : ",") + column.about.name;
    }
    file.write(line + '\n');
    for (std::size_t row = 0; row < table.rows(); ++row) {
        if (stopped(row, stop)) {
            return false;
        }
        line.clear();
        for (const TableColumn& column : table.columns) {
            line += line.empty() ? "" : ",";
            append_csv_number(line, column.values[row]);
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
        fields.push_back({column.about.name, "<f8"});
    }
    file.write(npy_header({fields, {table.rows()}}));
    std::vector<double> numbers(table.columns.size());
    for (std::size_t row = 0; row < table.rows(); ++row) {
        if (stopped(row, stop)) {
            return false;
        }
        std::ranges::transform(table.columns, numbers.begin(),
                               [row](const TableColumn& column) { return column.values[row]; });
        file.write(std::as_bytes(std::span(numbers)));
    }
    const std::string text =
        text_of(Json{{"columns", table_columns_json(table)}, {"provenance", table.provenance}});
    file.write(npy_header({{{"", "|S" + std::to_string(text.size())}}, {}}) + text);
    file.commit();
    return true;
}

struct TableFormat {
    std::string_view ending;
    double bytes_per_number;  // from above
    bool (*write)(const fs::path&, const Table&, const std::atomic<bool>&);
};

constexpr std::array formats{
    TableFormat{".csv", 24, write_csv},
    TableFormat{".npy", 8, write_npy},
    TableFormat{".h5", 8, write_hdf5_table},
};

const TableFormat* format_of(const fs::path& path) {
    const std::string ending = recording_ending(path);
    const auto* const found = std::ranges::find(formats, ending, &TableFormat::ending);
    return found != formats.end() ? found : nullptr;
}

}  // namespace

Json table_columns_json(const Table& table) {
    Json columns = Json::array();
    for (const TableColumn& column : table.columns) {
        columns.push_back(Json::array({column.about.name, column.about.quantity, column.about.unit}));
    }
    return columns;
}

std::string table_endings() {
    std::string endings;
    for (const TableFormat& format : formats) {
        endings += (endings.empty() ? "" : ", ") + std::string(format.ending);
    }
    return endings;
}

std::optional<std::string> table_fault(const fs::path& path) {
    if (format_of(path) != nullptr) {
        return std::nullopt;
    }
    return fmt::format("{}: found the ending \"{}\", allowed: {}", path.string(), recording_ending(path),
                       table_endings());
}

double table_bytes(const fs::path& path, double columns, double rows) noexcept {
    const TableFormat* format = format_of(path);
    return format != nullptr ? rows * columns * format->bytes_per_number : 0;
}

bool write_table(const fs::path& path, const Table& table, const std::atomic<bool>& stop) {
    const TableFormat* format = format_of(path);
    if (format == nullptr) {
        throw std::runtime_error(*table_fault(path));
    }
    return format->write(path, table, stop);
}

}  // namespace hertzline::recordings
