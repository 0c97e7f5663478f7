#pragma once
// The HDF5 library: its handles, its errors, and the lock that admits one thread at a time.

#include <filesystem>
#include <mutex>
#include <stdexcept>
#include <string>
#include <utility>

#include "recordings/formats/hdf5/hdf5_functions.hpp"

namespace hertzline::recordings {

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
    /// For files of hdf5_access(): the first system error of a write is left in `write_failure`. Further writes are
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

/// Returns properties for H5Fcreate of a file whose writing may fail. The library cannot close such a file and
/// crashes when the program ends, so write errors are hidden from it: see Hdf5Library. Takes any existing file.
Hdf5Object hdf5_access(const std::filesystem::path& existing);

/// Returns the type of a string of any length; the library's own have a fixed length.
Hdf5Object hdf5_text_type();

}  // namespace hertzline::recordings
