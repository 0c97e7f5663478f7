#pragma once
// A library of the system that is loaded when it is needed: linked, it would take its time, and that of the libraries that it brings
// along, at every start of the program.

namespace hertzline::recordings {

/// Loaded, and never let go.
class SharedLibrary {
public:
    /// @param name under which the system has it, "libsndfile.so.1" @throws std::runtime_error when it is not there
    explicit SharedLibrary(const char* name);

    /// Sets a pointer to a function. @throws std::runtime_error when the library does not have it
    template <class Function>
    void find(Function*& function, const char* symbol) const {
        function = reinterpret_cast<Function*>(address(symbol));
    }

    /// Returns the address of a function or a variable. @throws std::runtime_error when the library does not have it
    void* address(const char* symbol) const;

private:
    void* handle_;
};

}  // namespace hertzline::recordings
