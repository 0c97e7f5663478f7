#include <algorithm>

#include "recordings/formats/hdf5/hdf5.hpp"
#include "recordings/formats/hdf5/hdf5_layout.hpp"
#include "recordings/formats/hdf5/hdf5_whole_file.hpp"
#include "recordings/formats/table.hpp"
#include "recordings/recording_head.hpp"

namespace hertzline::recordings {

namespace {

constexpr std::size_t portion = std::size_t{1} << 18;  // rows between looks at the stop flag
constexpr hsize_t chunk = 1 << 14;

/// False once `stop` is true.
bool write_columns(hid_t file, const Table& table, const std::atomic<bool>& stop) {
    for (const TableColumn& column : table.columns) {
        const Hdf5Object dataset =
            hdf5_create_dataset(file, column.about.quantity, H5T_IEEE_F64LE, 1, 1, {chunk, 1});
        hdf5_write_text(dataset.id(), "units", column.about.unit);
        for (std::size_t row = 0; row < column.values.size(); row += portion) {
            if (stop.load(std::memory_order_relaxed)) {
                return false;
            }
            const std::size_t rows = std::min(portion, column.values.size() - row);
            hdf5_append_rows(dataset.id(), H5T_NATIVE_DOUBLE, static_cast<std::int64_t>(row),
                             static_cast<std::int64_t>(rows), 1, column.values.data() + row);
        }
    }
    return true;
}

}  // namespace

bool write_hdf5_table(const std::filesystem::path& path, const Table& table, const std::atomic<bool>& stop) {
    return write_whole_hdf5(path, [&](hid_t file) {
        hdf5_write_text(file, "columns", text_of(table_columns_json(table)));
        hdf5_write_text(file, "provenance", text_of(table.provenance));
        return write_columns(file, table, stop);
    });
}

}  // namespace hertzline::recordings
