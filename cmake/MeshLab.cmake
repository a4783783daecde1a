# SPDX-License-Identifier: GPL-3.0-or-later
# The host: the installed MeshLab, or PyMeshLab's folder where PARTS_PYMESHLAB
# names it, and the function that makes a plugin for it.
set(PARTS_PYMESHLAB "" CACHE PATH "Folder of Python's package pymeshlab, to build plugins for it; else for MeshLab")

# MeshLab's headers (with vcglib), which no Debian binary package carries.
if(NOT MESHLAB_HEADERS)
  execute_process(
    COMMAND "${CMAKE_CURRENT_LIST_DIR}/fetch-meshlab-headers.sh" --fetched
    OUTPUT_VARIABLE MESHLAB_HEADERS OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_VARIABLE why RESULT_VARIABLE failed)
  if(failed)
    string(STRIP "${why}" why)
    message(FATAL_ERROR "${why}")
  endif()
  set(MESHLAB_HEADERS "${MESHLAB_HEADERS}" CACHE PATH "Folder with MeshLab's src/common and vcglib")
endif()

find_package(Qt5 REQUIRED COMPONENTS Core Gui Widgets OpenGL Xml)
find_package(OpenGL REQUIRED)
if(PARTS_PYMESHLAB)
  set(MESHLAB_COMMON_LIBRARY "${PARTS_PYMESHLAB}/lib/libmeshlab-common.so")
  set(meshlab_lib_dir "${PARTS_PYMESHLAB}/lib")
  set(host_scalar double)
else()
  find_library(MESHLAB_COMMON_LIBRARY meshlab-common PATH_SUFFIXES meshlab REQUIRED)
  find_program(MESHLAB_PROGRAM meshlab REQUIRED)
  find_program(MESHLAB_SERVER_PROGRAM meshlabserver)  # of 2020.09 alone
  mark_as_advanced(MESHLAB_COMMON_LIBRARY MESHLAB_PROGRAM MESHLAB_SERVER_PROGRAM)
  get_filename_component(meshlab_lib_dir "${MESHLAB_COMMON_LIBRARY}" DIRECTORY)        # /usr/lib/<triplet>/meshlab
  get_filename_component(meshlab_bin_dir "${MESHLAB_PROGRAM}" DIRECTORY)
  get_filename_component(meshlab_prefix "${meshlab_bin_dir}" DIRECTORY)                # /usr
  set(host_scalar float)
endif()
set(MESHLAB_PLUGIN_DIR "${meshlab_lib_dir}/plugins" CACHE PATH "Where 'cmake --install' puts the plugins")

# Hosts of one generation share an API, and a folder shared/host/meshlab<generation>.
if(EXISTS "${MESHLAB_HEADERS}/src/common/interfaces.h")
  set(MESHLAB_GENERATION 2020)
else()
  set(MESHLAB_GENERATION 2022)
endif()
file(STRINGS "${MESHLAB_HEADERS}/ML_VERSION" MESHLAB_VERSION LIMIT_COUNT 1)  # the host refuses plugins for another
set(MESHLAB_SCALAR ${host_scalar} CACHE STRING "The host's numbers: float in Debian's builds, double in PyMeshLab")
message(STATUS "MeshLab ${MESHLAB_VERSION} (${MESHLAB_SCALAR}), API of ${MESHLAB_GENERATION}")

# MeshLab's API.
add_library(deps::meshlab INTERFACE IMPORTED GLOBAL)
target_include_directories(deps::meshlab SYSTEM INTERFACE "${MESHLAB_HEADERS}/src" "${MESHLAB_HEADERS}/vcglib")
target_compile_definitions(deps::meshlab INTERFACE
  "MESHLAB_SCALAR=${MESHLAB_SCALAR}" "MESHLAB_VERSION=${MESHLAB_VERSION}")
target_link_libraries(deps::meshlab INTERFACE
  "${MESHLAB_COMMON_LIBRARY}" deps::eigen Qt5::Core Qt5::Gui Qt5::Widgets Qt5::OpenGL Qt5::Xml OpenGL::GL)

if(PARTS_PYMESHLAB)
  set(PARTS_STAGE_PLUGIN_DIR "${PROJECT_BINARY_DIR}/pymeshlab")  # to be loaded from there
  configure_file("${CMAKE_CURRENT_LIST_DIR}/shapes_from_parts.py.in" "${PARTS_STAGE_PLUGIN_DIR}/shapes_from_parts.py" @ONLY)
else()
  include(Stage)
endif()

# add_meshlab_filter(<name> [<source>...])
# A MeshLab filter plugin from the given sources, or from every .h and .cpp of
# the calling folder; they define parts::host::filters(). It is built into the
# stage tree and installed beside MeshLab's own plugins. <name> is the folder's
# name.
function(add_meshlab_filter name)
  set(sources ${ARGN})
  if(NOT sources)
    file(GLOB sources CONFIGURE_DEPENDS "${CMAKE_CURRENT_SOURCE_DIR}/*.cpp" "${CMAKE_CURRENT_SOURCE_DIR}/*.h")
  endif()
  set_property(GLOBAL APPEND PROPERTY PARTS_PLUGINS ${name})
  add_library(${name} MODULE ${sources})
  target_link_libraries(${name} PRIVATE parts_plugin parts_host)
  set_target_properties(${name} PROPERTIES
    LIBRARY_OUTPUT_DIRECTORY "${PARTS_STAGE_PLUGIN_DIR}"
    BUILD_WITH_INSTALL_RPATH ON
    INSTALL_RPATH "$ORIGIN/..")
  # MeshLab resolves symbols late: a missing one must fail here, not on the user's click.
  target_link_options(${name} PRIVATE -Wl,--no-undefined -Wl,--exclude-libs,ALL)
  install(TARGETS ${name} LIBRARY DESTINATION "${MESHLAB_PLUGIN_DIR}" COMPONENT plugins)
endfunction()

# add_uninstall_target(<plugin>...)
# The target 'uninstall' takes the plugins and meshlab-script out of the system, also
# those that an earlier build put there.
function(add_uninstall_target)
  set(files ${ARGN})
  list(TRANSFORM files REPLACE "(.+)" "${MESHLAB_PLUGIN_DIR}/$<TARGET_FILE_NAME:\\1>")
  list(APPEND files "${meshlab_bin_dir}/meshlab-script")
  set(script "${PROJECT_BINARY_DIR}/uninstall.cmake")
  file(GENERATE OUTPUT "${script}" CONTENT
    "set(files \"${files}\")\ninclude(\"${PROJECT_SOURCE_DIR}/cmake/Uninstall.cmake\")\n")
  add_custom_target(uninstall COMMAND "${CMAKE_COMMAND}" -P "${script}"
    COMMENT "Removing the installed plugins" VERBATIM)
endfunction()
