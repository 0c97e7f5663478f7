#include "recordings/formats/hdf5/hdf5_library.hpp"

#include <cerrno>
#include <string_view>

#include <fcntl.h>
#include <unistd.h>

#include "recordings/files/staged_file.hpp"

namespace hertzline::recordings {
namespace {

/// Sets the functions and numbers; does nothing from the second time on.
/// @throws std::runtime_error when the library is not there
void load() {
    static const SharedLibrary loaded = [] {
        SharedLibrary library(HERTZLINE_HDF5_LIBRARY);
        HERTZLINE_HDF5_FUNCTIONS(HERTZLINE_FIND)
        if (H5open() < 0) {
            throw std::runtime_error("the HDF5 library does not start");
        }
#define HERTZLINE_NUMBER(name) name = *static_cast<const hid_t*>(library.address(#name));
        HERTZLINE_HDF5_NUMBERS(HERTZLINE_NUMBER)
#undef HERTZLINE_NUMBER
        return library;
    }();
    (void)loaded;
}

std::mutex library_mutex;

// Guarded by the mutex.
Hdf5WriteFailure* failure = nullptr;  // of the library's present holder
H5FD_class_t ordinary{};              // the library's driver for files

void note_failure(int error) noexcept {
    if (failure->reason == 0) {
        failure->reason = error != 0 ? error : EIO;
    }
}

template <class Write>
herr_t write_unless_failed(Write write) {
    if (failure == nullptr || failure->reason != 0) {
        return 0;
    }
    errno = 0;
    if (write() < 0) {
        note_failure(errno);
    }
    return 0;
}

herr_t write_bytes(H5FD_t* file, H5FD_mem_t type, hid_t transfer, haddr_t at, std::size_t size,
                   const void* bytes) {
    return write_unless_failed([&] { return ordinary.write(file, type, transfer, at, size, bytes); });
}

herr_t set_length(H5FD_t* file, hid_t transfer, hbool_t closing) {
    return write_unless_failed([&] { return ordinary.truncate(file, transfer, closing); });
}

/// The library aborts when it cannot close a file. So another descriptor of the file is closed first: the system reports
/// such an error once.
herr_t close_file(H5FD_t* file) {
    void* descriptor = nullptr;
    if (failure != nullptr && ordinary.get_handle(file, H5P_DEFAULT, &descriptor) >= 0) {
        const int other = ::fcntl(*static_cast<const int*>(descriptor), F_DUPFD_CLOEXEC, 0);
        if (other >= 0 && ::close(other) != 0 && errno != EINTR) {
            note_failure(errno);
            failure->doubtful = true;
        }
    }
    return ordinary.close(file);
}

/// The ordinary driver with these in its place. Its description is only to be had from an open file.
hid_t driver_made_from(const std::filesystem::path& existing) {
    const Hdf5Object access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
    hdf5(H5Pset_fapl_sec2(access.id()));
    H5FD_t* const file = H5FDopen(existing.c_str(), H5F_ACC_RDWR, access.id(), HADDR_UNDEF);
    if (file == nullptr) {
        throw std::runtime_error(hdf5_reason());
    }
    ordinary = *file->cls;
    H5FDclose(file);
    H5FD_class_t driver = ordinary;
    driver.write = write_bytes;
    driver.truncate = set_length;
    driver.close = close_file;
    return hdf5(H5FDregister(&driver));
}

/// Called from the innermost error outwards; the first one knows why.
herr_t take_first(unsigned index, const H5E_error2_t* error, void* text) {
    if (index == 0 && error->desc != nullptr) {
        *static_cast<std::string*>(text) = error->desc;
    }
    return 0;
}

}  // namespace

Hdf5Library::Hdf5Library(Hdf5WriteFailure* write_failure) : lock_(library_mutex) {
    load();
    failure = write_failure;
    H5Eget_auto2(H5E_DEFAULT, &print_, &print_data_);
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

Hdf5Library::~Hdf5Library() {
    H5Eset_auto2(H5E_DEFAULT, print_, print_data_);
    failure = nullptr;
}

std::string hdf5_reason() {
    std::string text = "HDF5 gives no reason";
    H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, take_first, &text);
    // "file write failed: time = ..., errno = 28, error message = 'No space left on device', buf = ..."
    constexpr std::string_view before = "error message = '";
    if (const std::size_t at = text.find(before); at != std::string::npos) {
        const std::size_t from = at + before.size();
        return text.substr(from, text.find('\'', from) - from);
    }
    return text;
}

Hdf5Object hdf5_create_file(const std::filesystem::path& existing) {
    static const hid_t driver = driver_made_from(existing);
    const Hdf5Object access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
    hdf5(H5Pset_driver(access.id(), driver, nullptr));
    hdf5(
        H5Pset_libver_bounds(access.id(), H5F_LIBVER_EARLIEST, H5F_LIBVER_LATEST));  // structures of Hdf5File
    return {H5Fcreate(existing.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access.id()), H5Fclose};
}

Hdf5Object hdf5_text_type() {
    Hdf5Object type(H5Tcopy(H5T_C_S1), H5Tclose);
    hdf5(H5Tset_size(type.id(), H5T_VARIABLE));
    hdf5(H5Tset_cset(type.id(), H5T_CSET_UTF8));
    return type;
}

void hdf5_write_text(hid_t object, const char* name, const std::string& text) {
    const Hdf5Object type = hdf5_text_type();
    const Hdf5Object space(H5Screate(H5S_SCALAR), H5Sclose);
    const Hdf5Object attribute(H5Acreate2(object, name, type.id(), space.id(), H5P_DEFAULT, H5P_DEFAULT),
                               H5Aclose);
    const char* const characters = text.c_str();
    hdf5(H5Awrite(attribute.id(), type.id(), &characters));
}

Hdf5Object hdf5_create_dataset(hid_t file, const std::string& name, hid_t type, int rank, hsize_t columns,
                               std::array<hsize_t, 2> chunk) {
    const std::array<hsize_t, 2> none{0, columns};
    const std::array<hsize_t, 2> most{H5S_UNLIMITED, columns};
    const Hdf5Object space(H5Screate_simple(rank, none.data(), most.data()), H5Sclose);
    const Hdf5Object properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    hdf5(H5Pset_chunk(properties.id(), rank, chunk.data()));
    return {H5Dcreate2(file, name.c_str(), type, space.id(), H5P_DEFAULT, properties.id(), H5P_DEFAULT),
            H5Dclose};
}

void hdf5_write_rows(hid_t dataset, hid_t type, std::int64_t row, std::int64_t rows, const void* values) {
    const Hdf5Object file(H5Dget_space(dataset), H5Sclose);
    std::array<hsize_t, 3> size{};
    const int rank = hdf5(H5Sget_simple_extent_dims(file.id(), size.data(), nullptr));
    const std::array<hsize_t, 3> from{static_cast<hsize_t>(row), 0, 0};
    size[0] = static_cast<hsize_t>(rows);
    hdf5(H5Sselect_hyperslab(file.id(), H5S_SELECT_SET, from.data(), nullptr, size.data(), nullptr));
    const Hdf5Object memory(H5Screate_simple(rank, size.data(), nullptr), H5Sclose);
    hdf5(H5Dwrite(dataset, type, memory.id(), file.id(), H5P_DEFAULT, values));
}

void hdf5_append_rows(hid_t dataset, hid_t type, std::int64_t row, std::int64_t rows, std::size_t columns,
                      const void* values) {
    const std::array<hsize_t, 2> size{static_cast<hsize_t>(row + rows), columns};
    hdf5(H5Dset_extent(dataset, size.data()));
    hdf5_write_rows(dataset, type, row, rows, values);
}

bool write_whole_hdf5(const std::filesystem::path& path, const std::function<bool(hid_t file)>& fill) {
    StagedFile staged(path, StagedFile::Devices::refused);
    Hdf5WriteFailure failure;
    bool written = false;
    {
        const Hdf5Library library(&failure);
        try {
            Hdf5Object file = hdf5_create_file(staged.temporary());
            written = fill(file.id());
            if (written) {
                hdf5(H5Fflush(file.id(), H5F_SCOPE_GLOBAL));
                file.close();
            }
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

}  // namespace hertzline::recordings
