# Writes git_hash.hpp with the commit that is being built: cmake -D SOURCE=dir -D OUTPUT=git_hash.hpp -P GitHash.cmake
# Run at each build; the file is touched only when the hash has changed. "unknown" where there is no git or no repository, and no tree
# that `git archive` has exported: it puts the hash into this file.
find_package(Git QUIET)
set(hash "")
if(GIT_FOUND)
  # Sources unpacked inside another repository do not belong to its commits.
  get_filename_component(above "${SOURCE}" DIRECTORY)
  set(ENV{GIT_CEILING_DIRECTORIES} "${above}")
  set(ENV{GIT_OPTIONAL_LOCKS} 0)
  execute_process(COMMAND ${GIT_EXECUTABLE} -C ${SOURCE} describe --always --dirty --abbrev=12 --exclude=*
    OUTPUT_VARIABLE hash ERROR_VARIABLE fault OUTPUT_STRIP_TRAILING_WHITESPACE)
  if(hash STREQUAL "" AND EXISTS "${SOURCE}/.git")
    message(WARNING "git does not name the commit, so recordings will say \"unknown\": ${fault}")
  endif()
endif()
set(exported "$Format:%H$")
if(hash STREQUAL "" AND exported MATCHES "^[0-9a-f]+$")
  string(SUBSTRING ${exported} 0 12 hash)
endif()
if(hash STREQUAL "")
  set(hash unknown)
endif()
file(CONFIGURE OUTPUT "${OUTPUT}" CONTENT "#pragma once\n#define HERTZLINE_GIT_HASH \"${hash}\"\n" @ONLY)
