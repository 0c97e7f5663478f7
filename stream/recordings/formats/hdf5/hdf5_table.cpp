#include <algorithm>
#include <stdexcept>

#include "stream/files/errors.hpp"
#include "stream/files/staged_file.hpp"
#include "stream/recordings/formats/hdf5/hdf5.hpp"
#include "stream/recordings/formats/hdf5/hdf5_layout.hpp"
#include "stream/recordings/formats/table.hpp"
#include "stream/recordings/recording_head.hpp"

namespace hertzline::stream {

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

bool write_file(const std::filesystem::path& temporary, const Table& table, const std::atomic<bool>& stop) {
    const Hdf5Object access = hdf5_access(temporary);
    Hdf5Object file(H5Fcreate(temporary.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access.id()), H5Fclose);
    hdf5_write_text(file.id(), "columns", text_of(table_columns_json(table)));
    hdf5_write_text(file.id(), "provenance", text_of(table.provenance));
    if (!write_columns(file.id(), table, stop)) {
        return false;
    }
    hdf5(H5Fflush(file.id(), H5F_SCOPE_GLOBAL));
    file.close();
    return true;
}

}  // namespace

bool write_hdf5_table(const std::filesystem::path& path, const Table& table, const std::atomic<bool>& stop) {
    StagedFile staged(path, StagedFile::Devices::refused);
    Hdf5WriteFailure failure;
    bool written = false;
    {
        const Hdf5Library library(&failure);
        try {
            written = write_file(staged.temporary(), table, stop);
        } catch (const std::runtime_error& error) {
            if (failure.reason == 0) {
                cannot_write(path, error.what());
            }
        }
    }
    if (failure.reason != 0) {
        staged.fail(failure.reason);
    }
    if (written) {
        staged.commit();
    }
    return written;
}

}  // namespace hertzline::stream
