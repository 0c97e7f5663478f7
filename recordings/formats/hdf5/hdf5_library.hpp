#pragma once
// The HDF5 library: its functions, handles and errors, the lock that admits one thread at a time, and the steps that
// recordings and tables share.
//
// It is loaded when the first HDF5 file is written: it brings two dozen others, and linked they would take two thirds of
// the start of every program. The names are HDF5's own. In this namespace they are pointers, so that code reads as if the
// library were linked; names that are not listed here do not link.

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <mutex>
#include <stdexcept>
#include <string>
#include <utility>

#include <hdf5.h>

#include "recordings/files/shared_library.hpp"

// clang-format off
#define HERTZLINE_HDF5_FUNCTIONS(X) \
    X(H5Aclose) X(H5Acreate2) X(H5Aget_space) X(H5Aget_type) X(H5Aopen) X(H5Aread) X(H5Awrite) \
    X(H5Dclose) X(H5Dcreate2) X(H5Dget_space) \
    X(H5Dget_type) X(H5Dopen2) X(H5Dread) X(H5Dset_extent) X(H5Dwrite) X(H5Eget_auto2) X(H5Eset_auto2) \
    X(H5Ewalk2) X(H5FDclose) X(H5FDopen) X(H5FDregister) X(H5Fclose) X(H5Fcreate) X(H5Fflush) X(H5Fopen) \
    X(H5Tget_member_name) X(H5Tget_nmembers) \
    X(H5Pclose) X(H5Pcreate) \
    X(H5Pset_chunk) X(H5Pset_deflate) X(H5Pset_driver) X(H5Pset_fapl_sec2) X(H5Pset_libver_bounds) X(H5Pset_obj_track_times) \
    X(H5Pset_shuffle) X(H5Sclose) X(H5Screate) X(H5Screate_simple) \
    X(H5Sget_simple_extent_dims) X(H5Sget_simple_extent_npoints) \
    X(H5Sselect_hyperslab) X(H5Tclose) X(H5Tcopy) X(H5Tcreate) \
    X(H5Tinsert) X(H5Tis_variable_str) \
    X(H5Tset_cset) X(H5Tset_size) X(H5check_version) X(H5free_memory) X(H5open)

/// Values of HDF5's names of types and classes, known once the library is open.
#define HERTZLINE_HDF5_NUMBERS(X) \
    X(H5P_CLS_DATASET_CREATE_ID_g) X(H5P_CLS_FILE_ACCESS_ID_g) X(H5T_C_S1_g) X(H5T_IEEE_F32LE_g) \
    X(H5T_IEEE_F64LE_g) X(H5T_NATIVE_DOUBLE_g) X(H5T_NATIVE_INT64_g) X(H5T_NATIVE_UCHAR_g) X(H5T_STD_I64LE_g) \
    X(H5T_STD_U8LE_g)
// clang-format on

namespace hertzline::recordings {

// NOLINTBEGIN(cppcoreguidelines-avoid-non-const-global-variables)
HERTZLINE_HDF5_FUNCTIONS(HERTZLINE_POINTER)
#define HERTZLINE_NUMBER(name) inline hid_t name = -1;
HERTZLINE_HDF5_NUMBERS(HERTZLINE_NUMBER)
#undef HERTZLINE_NUMBER
// NOLINTEND(cppcoreguidelines-avoid-non-const-global-variables)

/// The error of writing a file.
struct Hdf5WriteFailure {
    int reason = 0;         ///< errno of the first error; 0: none
    bool doubtful = false;  ///< the file could not be closed, so its contents are unknown
};

/// Hold it around every use of the library, closing of handles included: one thread at a time, and errors
/// are not printed to stderr meanwhile. The first one loads it.
class Hdf5Library {
public:
    /// @throws std::runtime_error when the library is not there
    Hdf5Library() : Hdf5Library(nullptr) {}
    /// For files of hdf5_create_file(): the first system error of a write is left in `write_failure`. Further writes are
    /// then skipped, although the library counts them as done.
    explicit Hdf5Library(Hdf5WriteFailure* write_failure);
    ~Hdf5Library();
    Hdf5Library(const Hdf5Library&) = delete;
    Hdf5Library& operator=(const Hdf5Library&) = delete;

private:
    std::scoped_lock<std::mutex> lock_;
    H5E_auto2_t print_ = nullptr;
    void* print_data_ = nullptr;
};

/// Returns the reason why the library's last call failed, the system's where it exists ("No space left on device").
std::string hdf5_reason();

/// Returns the value of a call. @throws std::runtime_error with the reason when it failed.
template <class Result>
Result hdf5(Result result) {
    if (result < 0) {
        throw std::runtime_error(hdf5_reason());
    }
    return result;
}

/// An object of the library, closed with it.
class Hdf5Object {
public:
    using Close = herr_t (*)(hid_t);

    Hdf5Object() = default;
    /// Takes the handle that a call returned. @throws std::runtime_error as hdf5() does.
    Hdf5Object(hid_t id, Close closing) : id_(hdf5(id)), close_(closing) {}
    Hdf5Object(Hdf5Object&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
    Hdf5Object& operator=(Hdf5Object&& other) noexcept {
        std::swap(id_, other.id_);
        std::swap(close_, other.close_);
        return *this;
    }
    ~Hdf5Object() {
        if (id_ >= 0) {
            close_(id_);
        }
    }

    hid_t id() const noexcept { return id_; }
    explicit operator bool() const noexcept { return id_ >= 0; }

    /// Closes now. @throws std::runtime_error when that fails.
    void close() {
        if (id_ >= 0) {
            hdf5(close_(id_));
            id_ = -1;
        }
    }

private:
    hid_t id_ = -1;
    Close close_ = nullptr;
};

/// Creates an HDF5 file. The library cannot close a file whose writing has failed and crashes when the program ends, so
/// write errors are hidden from it: see Hdf5Library. @param existing an ordinary file, whose contents go
Hdf5Object hdf5_create_file(const std::filesystem::path& existing);

/// Returns the type of a string of any length; the library's own have a fixed length.
Hdf5Object hdf5_text_type();

/// Gives an object an attribute.
void hdf5_write_text(hid_t object, const char* name, const std::string& text);

/// An empty dataset whose rows may be many. @param rank 1: of numbers; 2: of rows with so many columns
Hdf5Object hdf5_create_dataset(hid_t file, const std::string& name, hid_t type, int rank, hsize_t columns,
                               std::array<hsize_t, 2> chunk);

/// Writes rows of a dataset that has them. @param type of the values in memory
void hdf5_write_rows(hid_t dataset, hid_t type, std::int64_t row, std::int64_t rows, const void* values);

/// Makes the dataset so many rows longer than `row`, and writes them. @param type of the values in memory
void hdf5_append_rows(hid_t dataset, hid_t type, std::int64_t row, std::int64_t rows, std::size_t columns,
                      const void* values);

/// Writes an HDF5 file at once: under a temporary name, and gives it its own when it is whole.
/// @param fill writes the contents; false: it was stopped, and no file is left
/// @returns the result of fill @throws std::system_error that names the path if it cannot be written
bool write_whole_hdf5(const std::filesystem::path& path, const std::function<bool(hid_t file)>& fill);

}  // namespace hertzline::recordings
