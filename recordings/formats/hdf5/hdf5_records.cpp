#include "recordings/formats/hdf5/hdf5_records.hpp"

#include <algorithm>
#include <array>

#include "recordings/formats/hdf5/hdf5_layout.hpp"
#include "recordings/formats/hdf5/hdf5_whole_file.hpp"

namespace hertzline::recordings {

namespace {

constexpr std::size_t record_chunk_bytes = std::size_t{1} << 18;
constexpr unsigned deflate_level = 4;

Hdf5Object type_of(const RecordField& field) {
    if (field.kind == RecordKind::text) {
        Hdf5Object type(H5Tcopy(H5T_C_S1), H5Tclose);
        hdf5(H5Tset_size(type.id(), field.bytes));
        return type;
    }
    return {H5Tcopy(field.kind == RecordKind::integer ? H5T_STD_I64LE : H5T_IEEE_F64LE), H5Tclose};
}

Hdf5Object record_type(const RecordFile& records) {
    Hdf5Object type(H5Tcreate(H5T_COMPOUND, records.record_bytes()), H5Tclose);
    std::size_t offset = 0;
    for (const RecordField& field : records.fields) {
        const Hdf5Object member = type_of(field);
        hdf5(H5Tinsert(type.id(), field.name.c_str(), offset, member.id()));
        offset += field.bytes;
    }
    return type;
}

/// Rows of so many bytes that fit into a chunk, at least one.
hsize_t rows_in_chunk(std::size_t bytes) {
    return std::max<hsize_t>(1, record_chunk_bytes / std::max<std::size_t>(1, bytes));
}

Hdf5Object create_dataset(hid_t file, const std::string& name, hid_t type, const std::vector<hsize_t>& size,
                          const std::vector<hsize_t>& chunk) {
    const auto rank = static_cast<int>(size.size());
    const Hdf5Object space(H5Screate_simple(rank, size.data(), nullptr), H5Sclose);
    const Hdf5Object properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    hdf5(H5Pset_chunk(properties.id(), rank, chunk.data()));
    hdf5(H5Pset_shuffle(properties.id()));
    hdf5(H5Pset_deflate(properties.id(), deflate_level));
    hdf5(H5Pset_obj_track_times(properties.id(), false));
    return {H5Dcreate2(file, name.c_str(), type, space.id(), H5P_DEFAULT, properties.id(), H5P_DEFAULT),
            H5Dclose};
}

/// An attribute of as many texts as there are.
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

void write_rows(hid_t dataset, hid_t type, std::int64_t first, std::int64_t rows, const void* values) {
    const Hdf5Rows part(dataset, first, rows);
    hdf5(H5Dwrite(dataset, type, part.memory.id(), part.file.id(), H5P_DEFAULT, values));
}

/// The datasets of an open file.
class RecordWriter {
public:
    RecordWriter(hid_t file, const RecordFile& records)
        : records_(records), type_(record_type(records)), rows_(rows_in_chunk(records.record_bytes())) {
        const auto count = static_cast<hsize_t>(records.records);
        table_ = create_dataset(file, records.table, type_.id(), {count}, {std::min(rows_, count)});
        std::vector<std::string> units;
        std::ranges::transform(records.fields, std::back_inserter(units), &RecordField::unit);
        write_texts(table_.id(), "units", units);
        if (records.matrix) {
            const hsize_t samples = records.matrix->samples;
            rows_ = std::min(rows_, rows_in_chunk(samples * sizeof(float)));
            matrix_ = create_dataset(file, records.matrix->name, H5T_IEEE_F32LE, {count, samples},
                                     {std::min(rows_, count), samples});
            hdf5_write_text(matrix_.id(), "units", records.matrix->unit);
        }
    }

    /// False once `stop` is true.
    bool write(const std::atomic<bool>& stop) {
        const std::size_t bytes = records_.record_bytes();
        const std::size_t samples = records_.matrix ? records_.matrix->samples : 0;
        std::vector<std::byte> fields(rows_ * bytes);
        std::vector<float> matrix(rows_ * samples);
        for (std::int64_t first = 0; first < records_.records; first += static_cast<std::int64_t>(rows_)) {
            if (stop.load(std::memory_order_relaxed)) {
                return false;
            }
            const auto rows = std::min(static_cast<std::int64_t>(rows_), records_.records - first);
            for (std::int64_t row = 0; row < rows; ++row) {
                const auto at = static_cast<std::size_t>(row);
                records_.read(first + row, std::span(fields).subspan(at * bytes, bytes),
                              std::span(matrix).subspan(at * samples, samples));
            }
            write_rows(table_.id(), type_.id(), first, rows, fields.data());
            if (records_.matrix) {
                write_rows(matrix_.id(), H5T_IEEE_F32LE, first, rows, matrix.data());
            }
        }
        return true;
    }

private:
    const RecordFile& records_;
    Hdf5Object type_;
    hsize_t rows_;  // that are written at a time
    Hdf5Object table_;
    Hdf5Object matrix_;
};

}  // namespace

std::size_t RecordFile::record_bytes() const noexcept {
    std::size_t bytes = 0;
    for (const RecordField& field : fields) {
        bytes += field.bytes;
    }
    return bytes;
}

bool write_hdf5_records(const std::filesystem::path& path, const RecordFile& records,
                        const std::atomic<bool>& stop) {
    return write_whole_hdf5(path, [&](hid_t file) {
        for (const auto& [name, text] : records.attributes) {
            hdf5_write_text(file, name.c_str(), text);
        }
        return RecordWriter(file, records).write(stop);
    });
}

}  // namespace hertzline::recordings
