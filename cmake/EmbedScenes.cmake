# Writes shipped_scenes() with the text of every scene: cmake -D SCENES=a.toml;b.toml -D OUTPUT=x.cpp -P EmbedScenes.cmake
# The first line of a scene must be a comment: its description.
set(rows "")
list(TRANSFORM SCENES REPLACE "\\.toml$" "")  # sorted by name: by file name, "a-b" would come before "a"
list(SORT SCENES)
foreach(scene IN LISTS SCENES)
  set(file "${scene}.toml")
  file(READ "${file}" text)
  get_filename_component(name "${scene}" NAME)
  if(NOT "${text}" MATCHES "^# ([^\n]+)\n")
    message(FATAL_ERROR "${file}: the first line must be a comment that describes the scene")
  endif()
  set(description "${CMAKE_MATCH_1}")
  string(APPEND rows "    {\"${name}\",\n     R\"scene(${description})scene\",\n     R\"scene(${text})scene\"},\n")
endforeach()

file(WRITE "${OUTPUT}" "// Generated from scenes/*.toml by cmake/EmbedScenes.cmake.
#include \"hertzline/scene_file.hpp\"

#include <array>

namespace hertzline {

namespace {

constexpr auto scenes = std::to_array<ShippedScene>({
${rows}});

}  // namespace

std::span<const ShippedScene> shipped_scenes() noexcept {
    return scenes;
}

}  // namespace hertzline
")
