# SPDX-License-Identifier: GPL-3.0-or-later
# A tree in which MeshLab runs with this project's plugins, so that no system
# file is touched. MeshLab finds its libraries and plugins relative to the
# real place of its program, so the programs are copied and the rest is linked.
set(PARTS_STAGE_DIR "${PROJECT_BINARY_DIR}/stage")
file(RELATIVE_PATH meshlab_lib_subdir "${meshlab_prefix}" "${meshlab_lib_dir}")
set(stage_lib_dir "${PARTS_STAGE_DIR}/${meshlab_lib_subdir}")
set(PARTS_STAGE_PLUGIN_DIR "${stage_lib_dir}/plugins")

set(programs "${MESHLAB_PROGRAM}")
if(MESHLAB_SERVER_PROGRAM)
  list(APPEND programs "${MESHLAB_SERVER_PROGRAM}")
endif()
file(COPY ${programs} DESTINATION "${PARTS_STAGE_DIR}/bin")
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${programs} "${meshlab_lib_dir}/plugins")
file(MAKE_DIRECTORY "${PARTS_STAGE_PLUGIN_DIR}" "${PARTS_STAGE_DIR}/share")
file(GLOB host_libraries "${meshlab_lib_dir}/lib*.so*")
foreach(library IN LISTS host_libraries)
  get_filename_component(name "${library}" NAME)
  file(CREATE_LINK "${library}" "${stage_lib_dir}/${name}" SYMBOLIC)
endforeach()
file(CREATE_LINK "${meshlab_prefix}/share/meshlab" "${PARTS_STAGE_DIR}/share/meshlab" SYMBOLIC)

file(GLOB staged "${PARTS_STAGE_PLUGIN_DIR}/*")
foreach(file IN LISTS staged)  # links to what a MeshLab upgrade may have removed, plugins whose folder is gone
  get_filename_component(name "${file}" NAME_WE)
  string(REGEX REPLACE "^lib" "" name "${name}")
  if(IS_SYMLINK "${file}" OR NOT EXISTS "${PROJECT_SOURCE_DIR}/${name}/CMakeLists.txt")
    file(REMOVE "${file}")
  endif()
endforeach()
file(GLOB system_plugins "${meshlab_lib_dir}/plugins/*.so")
foreach(file IN LISTS system_plugins)
  get_filename_component(name "${file}" NAME)
  string(REGEX REPLACE "^lib(.*)\\.so$" "\\1" folder "${name}")
  if(NOT EXISTS "${PROJECT_SOURCE_DIR}/${folder}/CMakeLists.txt")  # an installed plugin of ours: the built one counts
    file(CREATE_LINK "${file}" "${PARTS_STAGE_PLUGIN_DIR}/${name}" SYMBOLIC)
  endif()
endforeach()
