#include "recordings/formats/hdf5/hdf5_library.hpp"

#include <cerrno>
#include <string_view>

#include <fcntl.h>
#include <unistd.h>

namespace hertzline::recordings {
namespace {

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
    load_hdf5();
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

Hdf5Object hdf5_access(const std::filesystem::path& existing) {
    static const hid_t driver = driver_made_from(existing);
    Hdf5Object access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
    hdf5(H5Pset_driver(access.id(), driver, nullptr));
    return access;
}

Hdf5Object hdf5_text_type() {
    Hdf5Object type(H5Tcopy(H5T_C_S1), H5Tclose);
    hdf5(H5Tset_size(type.id(), H5T_VARIABLE));
    hdf5(H5Tset_cset(type.id(), H5T_CSET_UTF8));
    return type;
}

}  // namespace hertzline::recordings
