#include <algorithm>
#include <array>
#include <cstring>
#include <iterator>
#include <stdexcept>

#include <fmt/format.h>

#include "core/scene/json.hpp"
#include "recordings/files/input_file.hpp"
#include "recordings/formats/hdf5/hdf5.hpp"
#include "recordings/formats/hdf5/hdf5_library.hpp"
#include "recordings/recording_head.hpp"

namespace hertzline::recordings {

namespace {

constexpr std::int64_t portion = std::int64_t{1} << 18;  // rows between looks at the stop flag
constexpr hsize_t chunk = 1 << 14;
constexpr std::size_t record_chunk_bytes = std::size_t{1} << 18;
constexpr unsigned deflate_level = 4;

/// A dataset for each column. False once `stop` is true.
bool write_columns(hid_t file, const Table& table, const std::atomic<bool>& stop) {
    TableRow here;
    std::vector<double> values;
    for (std::size_t column = 0; column < table.columns.size(); ++column) {
        const Column& about = table.columns[column].about;
        const Hdf5Object dataset =
            hdf5_create_dataset(file, about.quantity, H5T_IEEE_F64LE, 1, 1, {chunk, 1});
        hdf5_write_text(dataset.id(), "units", about.unit);
        for (std::int64_t row = 0; row < table.rows; row += portion) {
            if (stop.load(std::memory_order_relaxed)) {
                return false;
            }
            values.resize(static_cast<std::size_t>(std::min(portion, table.rows - row)));
            for (std::size_t i = 0; i < values.size(); ++i) {
                table.read(row + static_cast<std::int64_t>(i), here);
                values[i] = std::get<double>(here.cells[column]);
            }
            hdf5_append_rows(dataset.id(), H5T_NATIVE_DOUBLE, row, static_cast<std::int64_t>(values.size()),
                             1, values.data());
        }
    }
    return true;
}

Hdf5Object type_of(const TableColumn& column) {
    if (column.kind == CellKind::text) {
        Hdf5Object type(H5Tcopy(H5T_C_S1), H5Tclose);
        hdf5(H5Tset_size(type.id(), column.bytes));
        hdf5(H5Tset_cset(type.id(), H5T_CSET_UTF8));
        return type;
    }
    return {H5Tcopy(column.kind == CellKind::integer ? H5T_STD_I64LE : H5T_IEEE_F64LE), H5Tclose};
}

std::size_t record_bytes(std::span<const TableColumn> columns) noexcept {
    std::size_t bytes = 0;
    for (const TableColumn& column : columns) {
        bytes += column.bytes;
    }
    return bytes;
}

/// The cells one after the other, little-endian, texts filled up with zeros.
Hdf5Object record_type(std::span<const TableColumn> columns) {
    Hdf5Object type(H5Tcreate(H5T_COMPOUND, record_bytes(columns)), H5Tclose);
    std::size_t offset = 0;
    for (const TableColumn& column : columns) {
        const Hdf5Object member = type_of(column);
        hdf5(H5Tinsert(type.id(), column.about.name.c_str(), offset, member.id()));
        offset += column.bytes;
    }
    return type;
}

void to_record(const std::vector<Cell>& cells, std::span<const TableColumn> columns,
               std::span<std::byte> record) {
    std::ranges::fill(record, std::byte{0});
    std::byte* place = record.data();
    for (std::size_t i = 0; i < cells.size(); ++i) {
        if (const auto* text = std::get_if<std::string>(&cells[i])) {
            std::memcpy(place, text->data(), std::min(text->size(), columns[i].bytes));
        } else if (const auto* number = std::get_if<double>(&cells[i])) {
            std::memcpy(place, number, sizeof(double));
        } else {
            std::memcpy(place, &std::get<std::int64_t>(cells[i]), sizeof(std::int64_t));
        }
        place += columns[i].bytes;
    }
}

template <class Number>
Number number_at(const std::byte* place) {
    Number number{};
    std::memcpy(&number, place, sizeof(Number));
    return number;
}

TableRow from_record(std::span<const TableColumn> columns, std::span<const std::byte> record) {
    TableRow row;
    const std::byte* place = record.data();
    for (const TableColumn& column : columns) {
        if (column.kind == CellKind::text) {
            const std::string text(reinterpret_cast<const char*>(place), column.bytes);
            row.cells.emplace_back(text.substr(0, std::min(text.find('\0'), text.size())));
        } else if (column.kind == CellKind::number) {
            row.cells.emplace_back(number_at<double>(place));
        } else {
            row.cells.emplace_back(number_at<std::int64_t>(place));
        }
        place += column.bytes;
    }
    return row;
}

/// Rows of so many bytes that fit into a chunk, at least one.
hsize_t rows_in_chunk(std::size_t bytes) {
    return std::max<hsize_t>(1, record_chunk_bytes / std::max<std::size_t>(1, bytes));
}

Hdf5Object create_dataset(hid_t file, const std::string& name, hid_t type, const std::vector<hsize_t>& size,
                          const std::vector<hsize_t>& chunks) {
    const auto rank = static_cast<int>(size.size());
    const Hdf5Object space(H5Screate_simple(rank, size.data(), nullptr), H5Sclose);
    const Hdf5Object properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    hdf5(H5Pset_chunk(properties.id(), rank, chunks.data()));
    hdf5(H5Pset_shuffle(properties.id()));
    hdf5(H5Pset_deflate(properties.id(), deflate_level));
    hdf5(H5Pset_obj_track_times(properties.id(), false));
    return {H5Dcreate2(file, name.c_str(), type, space.id(), H5P_DEFAULT, properties.id(), H5P_DEFAULT),
            H5Dclose};
}

/// Gives an object an attribute of several texts.
void write_texts(hid_t object, const char* name, const std::vector<std::string>& texts) {
    const Hdf5Object type = hdf5_text_type();
    const hsize_t count = texts.size();
    const Hdf5Object space(H5Screate_simple(1, &count, nullptr), H5Sclose);
    const Hdf5Object attribute(H5Acreate2(object, name, type.id(), space.id(), H5P_DEFAULT, H5P_DEFAULT),
                               H5Aclose);
    std::vector<const char*> characters;
    std::ranges::transform(texts, std::back_inserter(characters),
                           [](const std::string& text) { return text.c_str(); });
    hdf5(H5Awrite(attribute.id(), type.id(), characters.data()));
}

/// The datasets of a table of records, in an open file.
class RecordWriter {
public:
    RecordWriter(hid_t file, const Table& table)
        : table_(table),
          type_(record_type(table.columns)),
          rows_(rows_in_chunk(record_bytes(table.columns))) {
        const auto count = static_cast<hsize_t>(table.rows);
        records_ = create_dataset(file, table.records, type_.id(), {count}, {std::min(rows_, count)});
        std::vector<std::string> units;
        std::ranges::transform(table.columns, std::back_inserter(units),
                               [](const TableColumn& column) { return column.about.unit; });
        write_texts(records_.id(), "units", units);
        if (table.samples) {
            const hsize_t samples = table.samples->count;
            const hsize_t channels = table.samples->channels;
            rows_ = std::min(rows_, rows_in_chunk(samples * channels * sizeof(float)));
            std::vector<hsize_t> size{count, samples};
            if (channels > 1) {
                size.push_back(channels);
            }
            std::vector<hsize_t> chunks = size;
            chunks.front() = std::min(rows_, count);
            samples_ = create_dataset(file, table.samples->name, H5T_IEEE_F32LE, size, chunks);
            hdf5_write_text(samples_.id(), "units", table.samples->unit);
        }
    }

    /// False once `stop` is true.
    bool write(const std::atomic<bool>& stop) {
        const std::size_t bytes = record_bytes(table_.columns);
        std::vector<std::byte> records(rows_ * bytes);
        std::vector<float> samples;
        TableRow here;
        for (std::int64_t first = 0; first < table_.rows; first += static_cast<std::int64_t>(rows_)) {
            if (stop.load(std::memory_order_relaxed)) {
                return false;
            }
            const auto rows = std::min(static_cast<std::int64_t>(rows_), table_.rows - first);
            samples.clear();
            for (std::int64_t row = 0; row < rows; ++row) {
                table_.read(first + row, here);
                to_record(here.cells, table_.columns,
                          std::span(records).subspan(static_cast<std::size_t>(row) * bytes, bytes));
                samples.insert(samples.end(), here.samples.begin(), here.samples.end());
            }
            hdf5_write_rows(records_.id(), type_.id(), first, rows, records.data());
            if (table_.samples) {
                hdf5_write_rows(samples_.id(), H5T_IEEE_F32LE, first, rows, samples.data());
            }
        }
        return true;
    }

private:
    const Table& table_;
    Hdf5Object type_;
    hsize_t rows_;  // that are written at a time
    Hdf5Object records_;
    Hdf5Object samples_;
};

/// Reads an attribute. @throws std::runtime_error when it is no text
std::string read_text(hid_t object, const char* name) {
    const Hdf5Object attribute(H5Aopen(object, name, H5P_DEFAULT), H5Aclose);
    const Hdf5Object type(H5Aget_type(attribute.id()), H5Tclose);
    const Hdf5Object space(H5Aget_space(attribute.id()), H5Sclose);
    if (hdf5(H5Tis_variable_str(type.id())) == 0 || H5Sget_simple_extent_npoints(space.id()) != 1) {
        throw std::runtime_error(fmt::format("attribute {} is not a string", name));
    }
    char* characters = nullptr;
    hdf5(H5Aread(attribute.id(), hdf5_text_type().id(), &characters));
    std::string text = characters != nullptr ? characters : "";
    H5free_memory(characters);
    return text;
}

/// Calls the work with the open file, inside the library.
template <class Work>
auto with_file(const std::filesystem::path& path, const Work& work) {
    const InputFile readable(path);  // or says why not, better than the library
    const Hdf5Library library;
    const Hdf5Object file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
    return work(file.id());
}

Hdf5Object open_records(hid_t file, const std::string& name) {
    return {H5Dopen2(file, name.c_str(), H5P_DEFAULT), H5Dclose};
}

std::vector<std::string> member_names(hid_t dataset) {
    const Hdf5Object type(H5Dget_type(dataset), H5Tclose);
    std::vector<std::string> names;
    for (int member = 0; member < hdf5(H5Tget_nmembers(type.id())); ++member) {
        char* const name = H5Tget_member_name(type.id(), static_cast<unsigned>(member));
        names.emplace_back(name != nullptr ? name : "");
        H5free_memory(name);
    }
    return names;
}

}  // namespace

bool write_hdf5_table(const std::filesystem::path& path, const Table& table, const std::atomic<bool>& stop) {
    return write_whole_hdf5(path, [&](hid_t file) {
        if (!table.records.empty()) {
            hdf5_write_text(file, "provenance", ascii_json_text(table.provenance));
            return RecordWriter(file, table).write(stop);
        }
        hdf5_write_text(file, "columns", ascii_json_text(table_columns_json(table)));
        hdf5_write_text(file, "provenance", ascii_json_text(table.provenance));
        return write_columns(file, table, stop);
    });
}

WrittenTable read_hdf5_table(const std::filesystem::path& path, const std::string& records) {
    return with_file(path, [&](hid_t file) {
        return WrittenTable{member_names(open_records(file, records).id()),
                            json_from_outside(read_text(file, "provenance"))};
    });
}

std::vector<TableRow> read_hdf5_table_rows(const std::filesystem::path& path, const std::string& records,
                                           std::span<const TableColumn> columns) {
    return with_file(path, [&](hid_t file) {
        const Hdf5Object dataset = open_records(file, records);
        const Hdf5Object space(H5Dget_space(dataset.id()), H5Sclose);
        const auto count = static_cast<std::size_t>(hdf5(H5Sget_simple_extent_npoints(space.id())));
        const std::size_t bytes = record_bytes(columns);
        const Hdf5Object type = record_type(columns);
        std::vector<std::byte> all(count * bytes);
        hdf5(H5Dread(dataset.id(), type.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, all.data()));
        std::vector<TableRow> rows;
        rows.reserve(count);
        for (std::size_t row = 0; row < count; ++row) {
            rows.push_back(from_record(columns, std::span(all).subspan(row * bytes, bytes)));
        }
        return rows;
    });
}

}  // namespace hertzline::recordings
