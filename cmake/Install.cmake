# Installs packages. find_package(hertzline COMPONENTS core stream) gives hertzline::core and hertzline::stream; pkg-config has
# hertzline-core and hertzline, which is both.
include(CMakePackageConfigHelpers)

# Every header of include/hertzline belongs to a module; hertzline.hpp includes them all.
file(GLOB headers CONFIGURE_DEPENDS RELATIVE ${PROJECT_SOURCE_DIR}/include/hertzline include/hertzline/*.hpp)
get_property(public_headers GLOBAL PROPERTY HERTZLINE_PUBLIC_HEADERS)
list(REMOVE_ITEM headers hertzline.hpp ${public_headers})
if(headers)
  message(FATAL_ERROR "include/hertzline has headers that no module names as public: ${headers}")
endif()

# All modules that others may use.
add_library(hertzline_everything INTERFACE)
add_library(hertzline::hertzline ALIAS hertzline_everything)
set_target_properties(hertzline_everything PROPERTIES EXPORT_NAME hertzline)
target_link_libraries(hertzline_everything INTERFACE hertzline_stream hertzline_studies)

install(TARGETS hertzline RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(TARGETS hertzline_core EXPORT hertzlineCoreTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(TARGETS hertzline_measures hertzline_recordings hertzline_studies hertzline_stream hertzline_everything
  EXPORT hertzlineStreamTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(DIRECTORY include/hertzline DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(PROGRAMS apps/plot/hertzline_plot.py DESTINATION ${CMAKE_INSTALL_DATADIR}/hertzline)
install(DIRECTORY apps/plot/hertzline_pictures DESTINATION ${CMAKE_INSTALL_DATADIR}/hertzline FILES_MATCHING PATTERN "*.py"
  PATTERN __pycache__ EXCLUDE)
install(DIRECTORY apps/matlab DESTINATION ${CMAKE_INSTALL_DATADIR}/hertzline)
install(DIRECTORY scenes DESTINATION ${CMAKE_INSTALL_DATADIR}/hertzline FILES_MATCHING PATTERN "*.toml")
install(DIRECTORY ${PROJECT_BINARY_DIR}/man/ DESTINATION ${CMAKE_INSTALL_MANDIR})
install(FILES apps/completion/hertzline.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME hertzline)
install(FILES apps/completion/hertzline.fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d)
set(HERTZLINE_ZSH_DIR ${CMAKE_INSTALL_DATADIR}/zsh/site-functions CACHE STRING
  "Folder for zsh's completion; that of Debian's packages is share/zsh/vendor-completions")
install(FILES apps/completion/hertzline.zsh DESTINATION ${HERTZLINE_ZSH_DIR} RENAME _hertzline)

set(config_dir ${CMAKE_INSTALL_LIBDIR}/cmake/hertzline)
install(EXPORT hertzlineCoreTargets NAMESPACE hertzline:: DESTINATION ${config_dir})
install(EXPORT hertzlineStreamTargets NAMESPACE hertzline:: DESTINATION ${config_dir})
configure_package_config_file(cmake/hertzlineConfig.cmake.in ${PROJECT_BINARY_DIR}/hertzlineConfig.cmake
  INSTALL_DESTINATION ${config_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/hertzlineConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/hertzlineConfig.cmake ${PROJECT_BINARY_DIR}/hertzlineConfigVersion.cmake
  cmake/CoreDependencies.cmake cmake/StreamDependencies.cmake DESTINATION ${config_dir})

# relative to the file's own place, so that --prefix may be given at installation
file(RELATIVE_PATH PC_TO_PREFIX "/${CMAKE_INSTALL_LIBDIR}/pkgconfig" "/")
foreach(name hertzline-core hertzline)
  configure_file(cmake/${name}.pc.in ${PROJECT_BINARY_DIR}/${name}.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/${name}.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
endforeach()
