# SPDX-FileCopyrightText: 2026 the trunnion authors
# SPDX-License-Identifier: BSD-3-Clause

# LCM as a peer for tests and benchmarks: Debian's 1.3.1 has no CMake package, later ones have. Defines the targets lcm
# and lcm-gen. The glib that lcm.pc asks for is not needed, so pkg-config is not used.
find_package(lcm CONFIG QUIET)
if(NOT TARGET lcm)
  find_path(LCM_INCLUDE_DIR lcm/lcm-cpp.hpp)
  find_library(LCM_LIBRARY lcm)
  find_program(LCM_GEN_EXECUTABLE lcm-gen)
  mark_as_advanced(LCM_INCLUDE_DIR LCM_LIBRARY LCM_GEN_EXECUTABLE)
  if(LCM_INCLUDE_DIR AND LCM_LIBRARY AND LCM_GEN_EXECUTABLE)
    add_library(lcm UNKNOWN IMPORTED)
    set_target_properties(lcm PROPERTIES IMPORTED_LOCATION ${LCM_LIBRARY} INTERFACE_INCLUDE_DIRECTORIES ${LCM_INCLUDE_DIR})
    add_executable(lcm-gen IMPORTED)
    set_target_properties(lcm-gen PROPERTIES IMPORTED_LOCATION ${LCM_GEN_EXECUTABLE})
  endif()
endif()
include(FindPackageHandleStandardArgs)
set(Lcm_TARGETS_DEFINED FALSE)
if(TARGET lcm AND TARGET lcm-gen)
  set(Lcm_TARGETS_DEFINED TRUE)
endif()
find_package_handle_standard_args(Lcm REQUIRED_VARS Lcm_TARGETS_DEFINED)
