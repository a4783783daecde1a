# SPDX-License-Identifier: GPL-3.0-or-later
# The libraries of the core, as imported targets. Debian's component packages
# come without CMake files, so most are found by header and library.

# parts_find_library(<target> <header> <library>... [INCLUDE_SUFFIXES <dir>...])
function(parts_find_library target header)
  cmake_parse_arguments(ARG "" "" "INCLUDE_SUFFIXES" ${ARGN})
  find_path(${target}_INCLUDE_DIR ${header} PATH_SUFFIXES ${ARG_INCLUDE_SUFFIXES})
  mark_as_advanced(${target}_INCLUDE_DIR)
  if(NOT ${target}_INCLUDE_DIR)
    message(FATAL_ERROR "The header ${header} was not found; './run setup' installs what is missing.")
  endif()
  add_library(${target} INTERFACE IMPORTED GLOBAL)
  target_include_directories(${target} SYSTEM INTERFACE "${${target}_INCLUDE_DIR}")
  foreach(library IN LISTS ARG_UNPARSED_ARGUMENTS)
    find_library(${library}_LIBRARY ${library})
    mark_as_advanced(${library}_LIBRARY)
    if(NOT ${library}_LIBRARY)
      message(FATAL_ERROR "The library ${library} was not found; './run setup' installs what is missing.")
    endif()
    target_link_libraries(${target} INTERFACE "${${library}_LIBRARY}")
  endforeach()
endfunction()

find_package(Threads REQUIRED)
parts_find_library(deps::eigen Eigen/Core INCLUDE_SUFFIXES eigen3)
parts_find_library(deps::opencv opencv2/core.hpp opencv_imgcodecs opencv_imgproc opencv_core INCLUDE_SUFFIXES opencv4)
parts_find_library(deps::flann flann/flann.hpp flann_cpp lz4)
parts_find_library(deps::expat expat.h expat)
parts_find_library(deps::maxflow maxflow.h maxflow INCLUDE_SUFFIXES maxflow-3.0)

# MeshLab's headers (with vcglib), which no Debian binary package carries.
if(NOT MESHLAB_HEADERS)
  execute_process(
    COMMAND "${CMAKE_CURRENT_LIST_DIR}/fetch-meshlab-headers.sh"
    OUTPUT_VARIABLE MESHLAB_HEADERS OUTPUT_STRIP_TRAILING_WHITESPACE RESULT_VARIABLE failed)
  if(failed)
    message(FATAL_ERROR "MeshLab's headers are missing, see above.")
  endif()
  set(MESHLAB_HEADERS "${MESHLAB_HEADERS}" CACHE PATH "Folder with MeshLab's src/common and vcglib")
endif()
add_library(deps::vcglib INTERFACE IMPORTED GLOBAL)
target_include_directories(deps::vcglib SYSTEM INTERFACE "${MESHLAB_HEADERS}/vcglib")
