#include "recordings/files/shared_library.hpp"

#include <stdexcept>
#include <string>

#include <dlfcn.h>

namespace hertzline::recordings {
namespace {

void* found_or_missing(void* found, const char* what) {
    if (found == nullptr) {
        const char* const reason = ::dlerror();
        throw std::runtime_error(std::string("a library is missing: ") + (reason != nullptr ? reason : what));
    }
    return found;
}

}  // namespace

SharedLibrary::SharedLibrary(const char* name)
    : handle_(found_or_missing(::dlopen(name, RTLD_NOW | RTLD_LOCAL), name)) {}

void* SharedLibrary::address(const char* symbol) const {
    return found_or_missing(::dlsym(handle_, symbol), symbol);
}

}  // namespace hertzline::recordings
