# Writes page_files() with the text of every file of the scope's page: cmake -D FILES=a.html;b.js -D OUTPUT=x.cpp -P EmbedPage.cmake
set(rows "")
list(SORT FILES)
foreach(file IN LISTS FILES)
  file(READ "${file}" text)
  get_filename_component(name "${file}" NAME)
  get_filename_component(ending "${file}" LAST_EXT)
  if(ending STREQUAL ".html")
    set(type "text/html; charset=utf-8")
  elseif(ending STREQUAL ".css")
    set(type "text/css; charset=utf-8")
  elseif(ending STREQUAL ".js")
    set(type "text/javascript; charset=utf-8")
  elseif(ending STREQUAL ".svg")
    set(type "image/svg+xml")
  else()
    message(FATAL_ERROR "${file}: a page has no files of this kind")
  endif()
  string(APPEND rows "    {\"${name}\", \"${type}\", R\"page(${text})page\"},\n")
endforeach()

file(WRITE "${OUTPUT}" "// Generated from scope/page/ by cmake/EmbedPage.cmake.
#include \"scope/server/page_server.hpp\"

#include <array>

namespace hertzline::scope {

namespace {

constexpr auto files = std::to_array<PageFile>({
${rows}});

}  // namespace

std::span<const PageFile> page_files() noexcept {
    return files;
}

}  // namespace hertzline::scope
")
