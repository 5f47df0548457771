# SPDX-FileCopyrightText: 2026 the trunnion authors
# SPDX-License-Identifier: BSD-3-Clause

# LCM 1.3.1 and later: Debian's has no CMake package, later ones and the Python wheel have. Defines the target lcm and,
# where the generator is there, lcm-gen. The glib that lcm.pc asks for is not needed, so pkg-config is not used.
find_package(lcm CONFIG QUIET)
if(NOT TARGET lcm)
  find_path(LCM_INCLUDE_DIR lcm/lcm.h)
  find_library(LCM_LIBRARY lcm)
  find_program(LCM_GEN_EXECUTABLE lcm-gen)
  mark_as_advanced(LCM_INCLUDE_DIR LCM_LIBRARY LCM_GEN_EXECUTABLE)
  if(LCM_INCLUDE_DIR AND LCM_LIBRARY)
    add_library(lcm UNKNOWN IMPORTED)
    set_target_properties(lcm PROPERTIES IMPORTED_LOCATION ${LCM_LIBRARY} INTERFACE_INCLUDE_DIRECTORIES ${LCM_INCLUDE_DIR})
  endif()
  if(LCM_GEN_EXECUTABLE AND NOT TARGET lcm-gen)
    add_executable(lcm-gen IMPORTED)
    set_target_properties(lcm-gen PROPERTIES IMPORTED_LOCATION ${LCM_GEN_EXECUTABLE})
  endif()
endif()
include(FindPackageHandleStandardArgs)
set(Lcm_TARGET_DEFINED FALSE)
if(TARGET lcm)
  set(Lcm_TARGET_DEFINED TRUE)
endif()
find_package_handle_standard_args(Lcm REQUIRED_VARS Lcm_TARGET_DEFINED)
