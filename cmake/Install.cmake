# Installs packages. find_package(hertzline COMPONENTS core stream) gives hertzline::core and hertzline::stream; pkg-config has
# hertzline-core and hertzline, which is both.
include(CMakePackageConfigHelpers)

set(write_headers ${PROJECT_SOURCE_DIR}/cmake/WritePublicHeaders.cmake)
set(headers_written ${PROJECT_BINARY_DIR}/public_headers_written)
file(GLOB_RECURSE headers CONFIGURE_DEPENDS core/*.hpp measures/*.hpp recordings/*.hpp studies/*.hpp stream/*.hpp)
add_custom_command(OUTPUT ${headers_written}
  COMMAND ${CMAKE_COMMAND} -DOUTPUT=${PROJECT_BINARY_DIR}/include/hertzline -P ${write_headers}
  COMMAND ${CMAKE_COMMAND} -E touch ${headers_written}
  DEPENDS ${headers} ${write_headers} cmake/PublicHeaders.cmake
  COMMENT "Writing the public headers"
  VERBATIM)
add_custom_target(hertzline_public_headers ALL DEPENDS ${headers_written})
add_dependencies(hertzline_core hertzline_public_headers)

install(TARGETS hertzline RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(TARGETS hertzline_core EXPORT hertzlineCoreTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(TARGETS hertzline_measures hertzline_recordings hertzline_studies hertzline_stream EXPORT hertzlineStreamTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(DIRECTORY ${PROJECT_BINARY_DIR}/include/hertzline DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(PROGRAMS apps/plot/hertzline_plot.py DESTINATION ${CMAKE_INSTALL_DATADIR}/hertzline)
install(DIRECTORY scenes DESTINATION ${CMAKE_INSTALL_DATADIR}/hertzline FILES_MATCHING PATTERN "*.toml")

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
