# SPDX-License-Identifier: GPL-3.0-or-later
# './run package' (cpack) makes a Debian package of the plugins, of
# meshlab-script and of the script templates, for exactly the MeshLab that they
# were built for: the host refuses plugins of another version, with a box at
# every start.
execute_process(COMMAND dpkg-query -W -f "\${source:Upstream-Version}" meshlab
  OUTPUT_VARIABLE host_package_version ERROR_QUIET)
set(package meshlab-shapes-from-parts)
file(GLOB templates CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/scripts/*.mlx")
install(FILES ${templates} DESTINATION "/usr/share/${package}/scripts" COMPONENT package EXCLUDE_FROM_ALL)
install(FILES "${PROJECT_SOURCE_DIR}/README.md" "${PROJECT_SOURCE_DIR}/CHANGELOG.md"
  DESTINATION "/usr/share/doc/${package}" COMPONENT package EXCLUDE_FROM_ALL)
install(FILES "${PROJECT_SOURCE_DIR}/LICENSE" DESTINATION "/usr/share/doc/${package}" RENAME copyright
  COMPONENT package EXCLUDE_FROM_ALL)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME ${package})
set(CPACK_PACKAGE_CONTACT "The authors of Shapes from Parts <nobody@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "MeshLab filters that make new models out of parts of others")
set(CPACK_INSTALL_CMAKE_PROJECTS
  "${PROJECT_BINARY_DIR};${PROJECT_NAME};plugins;/" "${PROJECT_BINARY_DIR};${PROJECT_NAME};package;/")
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_PACKAGE_RELEASE "1~meshlab${MESHLAB_VERSION}")
# libmeshlab-common.so lies in the private folder of the package meshlab and has
# no version of its own.
set(CPACK_DEBIAN_PACKAGE_DEPENDS
  "meshlab (>= ${host_package_version}), meshlab (<< ${host_package_version}+z)")
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS "${meshlab_lib_dir}")
set(CPACK_STRIP_FILES ON)
set(CPACK_SET_DESTDIR ON)  # everything goes to an absolute place
set(CPACK_INSTALL_PREFIX /usr)
include(CPack)
