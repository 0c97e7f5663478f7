# Every target of the project links hertzline_flags: one place for warnings and floating-point rules.
add_library(hertzline_flags INTERFACE)
target_compile_options(hertzline_flags INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion
  # g++ 12 sees overlaps in std::string operator+ that are not there (GCC bug 105651)
  $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>
  # The compiler may not fuse a*b+c on its own: where a fused operation is wanted the code says so.
  # Otherwise the bits of a result would depend on the compiler's mood and on the instruction set.
  -ffp-contract=off
  # sqrt as one instruction: nobody reads errno.
  -fno-math-errno)
# What a sanitizer adds to a function hides from g++ what a variable holds: it then warns of what is not so. The release build gives
# the warnings of the code as it is.
if(HERTZLINE_WERROR AND NOT HERTZLINE_SANITIZE)
  target_compile_options(hertzline_flags INTERFACE -Werror)
endif()

# For all targets at once, not in hertzline_flags: an object without them in a program with them gives false reports (of a vector
# that grew unseen, of a lock that was taken unseen), and a target could forget to link hertzline_flags.
set(HERTZLINE_SANITIZE "" CACHE STRING "Sanitizers to build with, e.g. address,undefined")
if(HERTZLINE_SANITIZE)
  add_compile_options(-fsanitize=${HERTZLINE_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  add_link_options(-fsanitize=${HERTZLINE_SANITIZE})
endif()

# The large headers of a target, compiled once for all its sources. Only with the sanitizers: the release build gives each source
# what it includes itself, so a missing include does not go unseen.
function(hertzline_precompile target)
  if(HERTZLINE_SANITIZE)
    target_precompile_headers(${target} PRIVATE ${ARGN})
  endif()
endfunction()

# With CMAKE_UNITY_BUILD the sources of each folder are compiled as one: the large headers are read once for all, which takes a third
# of the time. Names in unnamed namespaces are then a folder's, not a file's. Generated sources stay alone.
function(hertzline_unite_folders target)
  set_target_properties(${target} PROPERTIES UNITY_BUILD_MODE GROUP)
  foreach(source IN LISTS ARGN)
    cmake_path(GET source PARENT_PATH folder)
    cmake_path(IS_PREFIX CMAKE_CURRENT_SOURCE_DIR "${folder}" NORMALIZE written)
    if(written)
      cmake_path(RELATIVE_PATH folder BASE_DIRECTORY ${PROJECT_SOURCE_DIR})
      string(REPLACE "/" "-" group ${folder})
      set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${group})
    endif()
  endforeach()
endfunction()

# For code whose speed is nobody's concern, command line and tests: compiled in half the time. The undefined-behaviour sanitizer
# watches the libraries alone; the others need every object.
function(hertzline_build_quickly target)
  if(HERTZLINE_SANITIZE)
    target_compile_options(${target} PRIVATE -fno-sanitize=undefined)
  endif()
  target_compile_options(${target} PRIVATE ${ARGN})
endfunction()

# For libraries that the Python module is linked from: code that may lie anywhere, and whose functions still call each other
# directly, as in a program.
function(hertzline_for_modules target)
  if(HERTZLINE_PYTHON)
    set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE ON CXX_VISIBILITY_PRESET hidden)
  endif()
endfunction()
