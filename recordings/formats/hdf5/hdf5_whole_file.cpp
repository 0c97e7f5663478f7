#include "recordings/formats/hdf5/hdf5_whole_file.hpp"

#include <stdexcept>

#include "recordings/files/errors.hpp"
#include "recordings/files/staged_file.hpp"
#include "recordings/formats/hdf5/hdf5_layout.hpp"
#include "recordings/formats/hdf5/hdf5_library.hpp"

namespace hertzline::recordings {

namespace {

bool write_file(const std::filesystem::path& temporary, const std::function<bool(hid_t file)>& fill) {
    const Hdf5Object access = hdf5_access(temporary);
    Hdf5Object file(H5Fcreate(temporary.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access.id()), H5Fclose);
    if (!fill(file.id())) {
        return false;
    }
    hdf5(H5Fflush(file.id(), H5F_SCOPE_GLOBAL));
    file.close();
    return true;
}

}  // namespace

bool write_whole_hdf5(const std::filesystem::path& path, const std::function<bool(hid_t file)>& fill) {
    StagedFile staged(path, StagedFile::Devices::refused);
    Hdf5WriteFailure failure;
    bool written = false;
    {
        const Hdf5Library library(&failure);
        try {
            written = write_file(staged.temporary(), fill);
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
