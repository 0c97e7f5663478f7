# A room is a folder of the root that is one library. Its include directory is a folder of the build that holds a link to the room alone;
# targets that link the room inherit it. So "studies/sweep/plan.hpp" is found where hertzline_studies is linked, and nowhere else:
# target_link_libraries defines the direction of includes.

# Lets a target, and those that link it, include the headers of a folder of the root.
function(hertzline_room_headers target folder)
  get_target_property(type ${target} TYPE)
  set(scope PUBLIC)
  if(type STREQUAL "INTERFACE_LIBRARY")
    set(scope INTERFACE)
  endif()
  file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/rooms/${folder})
  file(CREATE_LINK ${PROJECT_SOURCE_DIR}/${folder} ${PROJECT_BINARY_DIR}/rooms/${folder}/${folder} SYMBOLIC)
  target_include_directories(${target} ${scope} $<BUILD_INTERFACE:${PROJECT_BINARY_DIR}/rooms/${folder}>)
endfunction()

# hertzline_room(NAME SOURCE...): makes the library hertzline_NAME of the sources in the folder of that name.
function(hertzline_room name)
  set(target hertzline_${name})
  add_library(${target} STATIC ${ARGN})
  add_library(hertzline::${name} ALIAS ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name} OUTPUT_NAME hertzline-${name})
  hertzline_room_headers(${target} ${name})
  hertzline_unite_folders(${target} ${ARGN})
  target_link_libraries(${target} PRIVATE $<BUILD_INTERFACE:hertzline_flags>)
  hertzline_for_modules(${target})
endfunction()
