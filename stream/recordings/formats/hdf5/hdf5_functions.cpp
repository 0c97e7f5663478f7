#include "stream/recordings/formats/hdf5/hdf5_functions.hpp"

#include <stdexcept>
#include <string>

#include <dlfcn.h>

namespace hertzline::stream {
namespace {

[[noreturn]] void missing(const char* what) {
    const char* const reason = ::dlerror();
    throw std::runtime_error(std::string("the HDF5 library: ") + (reason != nullptr ? reason : what));
}

void* symbol(void* library, const char* name) {
    void* const found = ::dlsym(library, name);
    if (found == nullptr) {
        missing(name);
    }
    return found;
}

void load() {
    void* const library = ::dlopen(HERTZLINE_HDF5_LIBRARY, RTLD_NOW | RTLD_LOCAL);
    if (library == nullptr) {
        missing(HERTZLINE_HDF5_LIBRARY);
    }
#define HERTZLINE_LOAD(name) name = reinterpret_cast<decltype(name)>(symbol(library, #name));
    HERTZLINE_HDF5_FUNCTIONS(HERTZLINE_LOAD)
#undef HERTZLINE_LOAD
    if (H5open() < 0) {
        throw std::runtime_error("the HDF5 library does not start");
    }
#define HERTZLINE_LOAD(name) name = *static_cast<const hid_t*>(symbol(library, #name));
    HERTZLINE_HDF5_NUMBERS(HERTZLINE_LOAD)
#undef HERTZLINE_LOAD
}

}  // namespace

void load_hdf5() {
    static const bool loaded = [] {
        load();
        return true;
    }();
    (void)loaded;
}

}  // namespace hertzline::stream
