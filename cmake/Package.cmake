# SPDX-License-Identifier: GPL-3.0-or-later
# What 'cmake --install BUILD --component core' puts into place: the core
# library for other programs, found by find_package(shapes_from_parts). A plain
# 'cmake --install' leaves it out: that is for who wants MeshLab's plugins.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

# install_core(<target>)
function(install_core target)
  set(folder "${CMAKE_INSTALL_LIBDIR}/cmake/${PROJECT_NAME}")
  set(made "${PROJECT_BINARY_DIR}/package")
  set_target_properties(${target} PROPERTIES EXPORT_NAME core OUTPUT_NAME ${PROJECT_NAME})
  target_include_directories(${target} PUBLIC "$<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>")
  install(TARGETS ${target} EXPORT ${PROJECT_NAME}
    ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}" COMPONENT core EXCLUDE_FROM_ALL)
  install(DIRECTORY "${PROJECT_SOURCE_DIR}/shared/" DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/parts"
    COMPONENT core EXCLUDE_FROM_ALL FILES_MATCHING PATTERN "*.h" PATTERN host EXCLUDE)
  install(EXPORT ${PROJECT_NAME} NAMESPACE ${PROJECT_NAME}:: FILE targets.cmake DESTINATION "${folder}"
    COMPONENT core EXCLUDE_FROM_ALL)
  configure_package_config_file("${PROJECT_SOURCE_DIR}/cmake/config.cmake.in" "${made}/${PROJECT_NAME}-config.cmake"
    INSTALL_DESTINATION "${folder}")
  write_basic_package_version_file("${made}/${PROJECT_NAME}-config-version.cmake" COMPATIBILITY SameMinorVersion)
  install(FILES "${made}/${PROJECT_NAME}-config.cmake" "${made}/${PROJECT_NAME}-config-version.cmake"
    "${PROJECT_SOURCE_DIR}/cmake/Dependencies.cmake" DESTINATION "${folder}" COMPONENT core EXCLUDE_FROM_ALL)
endfunction()
