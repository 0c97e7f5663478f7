# Libraries that hertzline::stream is linked with beside core's; included by the project itself and by find_package(hertzline).
find_package(Threads REQUIRED)
find_package(PkgConfig REQUIRED)
pkg_check_modules(FFTW REQUIRED IMPORTED_TARGET fftw3)
pkg_check_modules(ZMQ REQUIRED IMPORTED_TARGET libzmq)
# At the first configure CMake 3.25 takes -isystem folders for include directories; later, from its cache, for options. The commands
# would then differ, and everything would be compiled again.
get_target_property(options PkgConfig::ZMQ INTERFACE_COMPILE_OPTIONS)
list(FIND options "-isystem" at)
if(at GREATER -1)
  math(EXPR folder_at "${at} + 1")
  list(GET options ${folder_at} folder)
  list(REMOVE_AT options ${at} ${folder_at})
  set_property(TARGET PkgConfig::ZMQ PROPERTY INTERFACE_COMPILE_OPTIONS "${options}")
  set_property(TARGET PkgConfig::ZMQ APPEND PROPERTY INTERFACE_INCLUDE_DIRECTORIES ${folder})
endif()
pkg_check_modules(SODIUM REQUIRED IMPORTED_TARGET libsodium)
pkg_check_modules(NLOPT REQUIRED IMPORTED_TARGET nlopt_cxx)
pkg_check_modules(SQLITE REQUIRED IMPORTED_TARGET sqlite3)
