#pragma once
// Records as HDF5: a compound table of one dimension, chunked and compressed, and beside it a matrix with a row for each record.
//
//     /TABLE    [record]          compound; its attribute "units" has a text for each member
//     /MATRIX   [record][sample]  float32, with its "units"; optional
//     attributes of the root      texts that are given
//
// The file has the same bytes whenever it is written: it holds no times.

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace hertzline::recordings {

enum class RecordKind { integer, number, text };

/// A member of a record: an int64, a double, or a text of so many bytes that zeros fill up; one after the other, little-endian.
struct RecordField {
    std::string name;
    std::string unit;
    RecordKind kind = RecordKind::number;
    std::size_t bytes = sizeof(double);
};

struct RecordMatrix {
    std::string name;
    std::string unit;
    std::size_t samples = 0;
};

struct RecordFile {
    std::string table;
    std::vector<RecordField> fields;
    std::int64_t records = 0;
    std::optional<RecordMatrix> matrix;
    std::vector<std::pair<std::string, std::string>> attributes;  ///< of the root

    /// Fills in a record, and its row of the matrix (empty without one). Called once for each, in order.
    std::function<void(std::int64_t record, std::span<std::byte> fields, std::span<float> row)> read;

    std::size_t record_bytes() const noexcept;
};

/// Writes the file. It has its name when it is complete. False, and nothing is left, once `stop` is true.
/// @throws std::runtime_error that names the path and the reason; then nothing is left, either
bool write_hdf5_records(const std::filesystem::path& path, const RecordFile& records,
                        const std::atomic<bool>& stop);

}  // namespace hertzline::recordings
