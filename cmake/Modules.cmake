# A module is a folder of the root that is one library. Its headers are reached through a folder of the build that holds links to the
# module and to its public headers alone, which the module hands on to the targets that link it. So "studies/plan.hpp" and
# "hertzline/studies.hpp" are found where hertzline_studies is linked, and nowhere else: target_link_libraries gives the direction of
# includes. Installed, the public headers lie in one folder.

# Lets a target, and those that link it, include the headers of a folder of the root.
function(hertzline_module_headers target folder)
  get_target_property(type ${target} TYPE)
  set(scope PUBLIC)
  if(type STREQUAL "INTERFACE_LIBRARY")
    set(scope INTERFACE)
  endif()
  file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/modules/${folder})
  file(CREATE_LINK ${PROJECT_SOURCE_DIR}/${folder} ${PROJECT_BINARY_DIR}/modules/${folder}/${folder} SYMBOLIC)
  target_include_directories(${target} ${scope} $<BUILD_INTERFACE:${PROJECT_BINARY_DIR}/modules/${folder}>)
endfunction()

function(hertzline_public_headers module)
  set(folder ${PROJECT_BINARY_DIR}/modules/${module}/hertzline)
  file(REMOVE_RECURSE ${folder}) # a header that has moved to another module must be gone
  file(MAKE_DIRECTORY ${folder})
  foreach(header IN LISTS ARGN)
    file(CREATE_LINK ${PROJECT_SOURCE_DIR}/include/hertzline/${header} ${folder}/${header} SYMBOLIC)
  endforeach()
  set_property(GLOBAL APPEND PROPERTY HERTZLINE_PUBLIC_HEADERS ${ARGN})
endfunction()

# hertzline_module(NAME PUBLIC HEADER... SOURCES SOURCE...): the library hertzline_NAME of the sources in the folder of that name. The
# public headers lie in include/hertzline.
function(hertzline_module name)
  cmake_parse_arguments(ARG "" "" "PUBLIC;SOURCES" ${ARGN})
  set(target hertzline_${name})
  add_library(${target} STATIC ${ARG_SOURCES})
  add_library(hertzline::${name} ALIAS ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name} OUTPUT_NAME hertzline-${name})
  hertzline_module_headers(${target} ${name})
  hertzline_public_headers(${name} ${ARG_PUBLIC})
  hertzline_unite_folders(${target} ${ARG_SOURCES})
  target_link_libraries(${target} PRIVATE $<BUILD_INTERFACE:hertzline_flags>)
  hertzline_for_modules(${target})
endfunction()
