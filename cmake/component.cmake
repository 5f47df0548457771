# SPDX-FileCopyrightText: 2026 the trunnion authors
# SPDX-License-Identifier: BSD-3-Clause

# Warnings of our own targets; not exported.
add_library(trunnion_warnings INTERFACE)
target_compile_options(trunnion_warnings INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wsign-conversion -Wdouble-promotion $<$<BOOL:${TRUNNION_WERROR}>:-Werror>)

# trunnion_component(<name> INTERFACE|STATIC HEADERS <h>... [SOURCES <cpp>...] [LINKS <target>...] [PRIVATE_LINKS <target>...])
#
# Declares trunnion::<name>: headers relative to include/trunnion, sources relative to src. Install and export follow
# from it, and VERIFY_INTERFACE_HEADER_SETS compiles each header alone.
function(trunnion_component name kind)
  cmake_parse_arguments(ARG "" "" "HEADERS;SOURCES;LINKS;PRIVATE_LINKS" ${ARGN})
  set(target trunnion_${name})
  list(TRANSFORM ARG_HEADERS PREPEND ${PROJECT_SOURCE_DIR}/include/trunnion/)
  add_library(${target} ${kind} ${ARG_SOURCES})
  add_library(trunnion::${name} ALIAS ${target})
  if(kind STREQUAL INTERFACE)
    set(scope INTERFACE)
  else()
    set(scope PUBLIC)
    target_link_libraries(${target} PRIVATE $<BUILD_INTERFACE:trunnion_warnings> ${ARG_PRIVATE_LINKS})
    set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE ON)
  endif()
  target_sources(${target} ${scope} FILE_SET HEADERS BASE_DIRS ${PROJECT_SOURCE_DIR}/include FILES ${ARG_HEADERS})
  target_compile_features(${target} ${scope} cxx_std_17)
  target_link_libraries(${target} ${scope} ${ARG_LINKS})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name} VERIFY_INTERFACE_HEADER_SETS ${PROJECT_IS_TOP_LEVEL})
  install(TARGETS ${target} EXPORT trunnion-${name} ARCHIVE COMPONENT dev FILE_SET HEADERS COMPONENT dev)
  install(EXPORT trunnion-${name} NAMESPACE trunnion:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/trunnion COMPONENT dev)
  set_property(GLOBAL APPEND PROPERTY TRUNNION_COMPONENTS ${name})
endfunction()

# trunnion_find(<variable> <option> <package> [<arguments>...]): whether an optional dependency is there and wanted.
macro(trunnion_find variable option package)
  set(${variable} FALSE)
  if(NOT "${${option}}" STREQUAL "OFF")
    find_package(${package} QUIET ${ARGN})
    set(${variable} ${${package}_FOUND})
    if("${${option}}" STREQUAL "ON" AND NOT ${package}_FOUND)
      message(FATAL_ERROR "${option} is ON, but ${package} was not found.")
    endif()
  endif()
endmacro()
