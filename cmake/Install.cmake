# find_package(hertzline) gives hertzline::core and hertzline::stream; pkg-config knows hertzline.
include(CMakePackageConfigHelpers)

install(TARGETS hertzline RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(TARGETS hertzline_core hertzline_stream EXPORT hertzlineTargets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
foreach(folder core stream)
  install(DIRECTORY ${folder} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/hertzline
    FILES_MATCHING PATTERN "*.hpp")
endforeach()
install(DIRECTORY scenes DESTINATION ${CMAKE_INSTALL_DATADIR}/hertzline FILES_MATCHING PATTERN "*.toml")

set(config_dir ${CMAKE_INSTALL_LIBDIR}/cmake/hertzline)
install(EXPORT hertzlineTargets NAMESPACE hertzline:: DESTINATION ${config_dir})
configure_package_config_file(cmake/hertzlineConfig.cmake.in ${CMAKE_BINARY_DIR}/hertzlineConfig.cmake
  INSTALL_DESTINATION ${config_dir})
write_basic_package_version_file(${CMAKE_BINARY_DIR}/hertzlineConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/hertzlineConfig.cmake ${CMAKE_BINARY_DIR}/hertzlineConfigVersion.cmake
  cmake/Dependencies.cmake DESTINATION ${config_dir})

# relative to the file's own place, so that --prefix may be given at installation
file(RELATIVE_PATH PC_TO_PREFIX "/${CMAKE_INSTALL_LIBDIR}/pkgconfig" "/")
configure_file(cmake/hertzline.pc.in ${CMAKE_BINARY_DIR}/hertzline.pc @ONLY)
install(FILES ${CMAKE_BINARY_DIR}/hertzline.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
