# SPDX-License-Identifier: GPL-3.0-or-later
# The libraries of the core, as imported targets. Debian's component packages
# come without CMake files, so most are found by header and library. Installed
# beside the core, whose users need the same. What is not there is listed in
# PARTS_MISSING.
set(PARTS_MISSING "")

# parts_find_library(<target> <header> <library>... [INCLUDE_SUFFIXES <dir>...])
function(parts_find_library target header)
  if(TARGET ${target})
    return()
  endif()
  cmake_parse_arguments(ARG "" "" "INCLUDE_SUFFIXES" ${ARGN})
  find_path(${target}_INCLUDE_DIR ${header} PATH_SUFFIXES ${ARG_INCLUDE_SUFFIXES})
  mark_as_advanced(${target}_INCLUDE_DIR)
  if(NOT ${target}_INCLUDE_DIR)
    list(APPEND PARTS_MISSING ${header})
  endif()
  add_library(${target} INTERFACE IMPORTED GLOBAL)
  target_include_directories(${target} SYSTEM INTERFACE "${${target}_INCLUDE_DIR}")
  foreach(library IN LISTS ARG_UNPARSED_ARGUMENTS)
    find_library(${library}_LIBRARY ${library})
    mark_as_advanced(${library}_LIBRARY)
    if(NOT ${library}_LIBRARY)
      list(APPEND PARTS_MISSING "lib${library}")
    endif()
    target_link_libraries(${target} INTERFACE "${${library}_LIBRARY}")
  endforeach()
  set(PARTS_MISSING "${PARTS_MISSING}" PARENT_SCOPE)
endfunction()

parts_find_library(deps::eigen Eigen/Core INCLUDE_SUFFIXES eigen3)
parts_find_library(deps::opencv opencv2/core.hpp opencv_imgcodecs opencv_imgproc opencv_core INCLUDE_SUFFIXES opencv4)
parts_find_library(deps::tbb tbb/task_arena.h tbb)
parts_find_library(deps::nanoflann nanoflann.hpp)
parts_find_library(deps::pugixml pugixml.hpp pugixml)
parts_find_library(deps::json nlohmann/json.hpp)
parts_find_library(deps::maxflow maxflow.h maxflow INCLUDE_SUFFIXES maxflow-3.0)
