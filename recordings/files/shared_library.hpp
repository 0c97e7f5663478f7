#pragma once
// A library of the system that is loaded when it is needed: linked, it would take its time, and that of the libraries that it
// brings along, at every start of the program. Its functions are pointers of the same names, listed by an X-macro.

#include <stdexcept>
#include <string>

#include <dlfcn.h>

namespace hertzline::recordings {

/// Loaded, and never let go.
class SharedLibrary {
public:
    /// @param name under which the system has it, "libsndfile.so.1" @throws std::runtime_error when it is not there, or damaged
    explicit SharedLibrary(const char* name) : handle_(found(::dlopen(name, RTLD_NOW | RTLD_LOCAL), name)) {}

    /// Returns the address of a function or a variable. @throws std::runtime_error when the library does not have it
    void* address(const char* symbol) const { return found(::dlsym(handle_, symbol), symbol); }

    /// Sets a pointer to a function. @throws std::runtime_error when the library does not have it
    template <class Function>
    void find(Function*& function, const char* symbol) const {
        function = reinterpret_cast<Function*>(address(symbol));
    }

private:
    static void* found(void* address, const char* name) {
        if (address == nullptr) {
            const char* const reason = ::dlerror();
            throw std::runtime_error(std::string("cannot load a library: ") +
                                     (reason != nullptr ? reason : name));
        }
        return address;
    }

    void* handle_;
};

}  // namespace hertzline::recordings

/// Declares the pointer to a library's function, in the present namespace.
#define HERTZLINE_POINTER(name) inline decltype(&::name) name = nullptr;
/// Sets it from `library`.
#define HERTZLINE_FIND(name) library.find(name, #name);
