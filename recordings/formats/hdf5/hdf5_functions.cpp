#include "recordings/formats/hdf5/hdf5_functions.hpp"

#include <stdexcept>

#include "recordings/files/shared_library.hpp"

namespace hertzline::recordings {

void load_hdf5() {
    static const SharedLibrary loaded = [] {
        SharedLibrary library(HERTZLINE_HDF5_LIBRARY);
#define HERTZLINE_LOAD(name) library.find(name, #name);
        HERTZLINE_HDF5_FUNCTIONS(HERTZLINE_LOAD)
#undef HERTZLINE_LOAD
        if (H5open() < 0) {
            throw std::runtime_error("the HDF5 library does not start");
        }
#define HERTZLINE_LOAD(name) name = *static_cast<const hid_t*>(library.address(#name));
        HERTZLINE_HDF5_NUMBERS(HERTZLINE_LOAD)
#undef HERTZLINE_LOAD
        return library;
    }();
    (void)loaded;
}

}  // namespace hertzline::recordings
