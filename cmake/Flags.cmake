# Every target of the project links hertzline_flags: one place for warnings and floating-point rules.
add_library(hertzline_flags INTERFACE)
target_compile_options(hertzline_flags INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion
  # g++ 12 falsely reports overlaps in std::string operator+ (GCC bug 105651)
  $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>
  # The compiler may not fuse a*b+c on its own; the code names each fused operation.
  # Otherwise the bits of a result would depend on the compiler's version and on the instruction set.
  -ffp-contract=off
  # sqrt as one instruction: no code reads errno.
  -fno-math-errno)
# A sanitizer's checks hide the values of variables from g++, which then gives false warnings. The release build gives the true ones.
if(HERTZLINE_WERROR AND NOT HERTZLINE_SANITIZE)
  target_compile_options(hertzline_flags INTERFACE -Werror)
endif()

# For all targets at once, not in hertzline_flags, which a target could forget to link: one object without a sanitizer in a program
# with it causes false reports (a vector that grew unseen, a lock that was taken unseen).
set(HERTZLINE_SANITIZE "" CACHE STRING "Sanitizers to build with, e.g. address,undefined")
if(HERTZLINE_SANITIZE)
  add_compile_options(-fsanitize=${HERTZLINE_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all
    # A check of each pointer takes two fifths of the time of compiling. The address sanitizer sees what goes wrong through it.
    -fno-sanitize=null,alignment,object-size,vptr)
  add_link_options(-fsanitize=${HERTZLINE_SANITIZE})
endif()

# Compiles the large headers of a target once for all its sources. Only with the sanitizers: in the release build each source sees
# only its own includes, so a missing include is noticed.
function(hertzline_precompile target)
  if(HERTZLINE_SANITIZE)
    target_precompile_headers(${target} PRIVATE ${ARGN})
  endif()
endfunction()

# Folders that are compiled with the one that they lie in: they are small, and no two of their names clash.
set(HERTZLINE_SMALL_FOLDERS
  "apps/(arguments|completion|console)" "apps/commands/.+" "recordings/formats/(csv|hdf5)" "stream/.+")
list(JOIN HERTZLINE_SMALL_FOLDERS "|" HERTZLINE_SMALL_FOLDERS)

# Makes CMAKE_UNITY_BUILD compile the sources of each folder as one: the large headers are read once for all, which takes a third of
# the time. Names in unnamed namespaces are then a folder's, not a file's. Generated sources are compiled alone.
function(hertzline_unite_folders target)
  set_target_properties(${target} PROPERTIES UNITY_BUILD_MODE GROUP)
  foreach(source IN LISTS ARGN)
    cmake_path(GET source PARENT_PATH folder)
    cmake_path(IS_PREFIX CMAKE_CURRENT_SOURCE_DIR "${folder}" NORMALIZE written)
    if(written)
      cmake_path(RELATIVE_PATH folder BASE_DIRECTORY ${PROJECT_SOURCE_DIR})
      while(folder MATCHES "^(${HERTZLINE_SMALL_FOLDERS})$")
        cmake_path(GET folder PARENT_PATH folder)
      endwhile()
      string(REPLACE "/" "-" group ${folder})
      set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${group})
    endif()
  endforeach()
endfunction()

# Compiles code whose speed does not matter (command line, tests) in half the time. The undefined-behaviour sanitizer checks the
# libraries alone; the other sanitizers need every object.
function(hertzline_build_quickly target)
  if(HERTZLINE_SANITIZE)
    target_compile_options(${target} PRIVATE -fno-sanitize=undefined)
  endif()
  target_compile_options(${target} PRIVATE ${ARGN})
endfunction()

# Makes a library fit for the Python module: position-independent code whose functions still call each other directly, as in a
# program.
function(hertzline_for_modules target)
  if(HERTZLINE_PYTHON)
    set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE ON CXX_VISIBILITY_PRESET hidden)
  endif()
endfunction()
