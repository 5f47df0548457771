# SPDX-FileCopyrightText: 2026 the trunnion authors
# SPDX-License-Identifier: BSD-3-Clause

# Man pages from the programs' own help, completion for bash, and packages: cpack -G DEB in the build folder makes
# trunnion (commands) and libtrunnion-dev (headers, libraries, CMake package).

find_program(HELP2MAN_EXECUTABLE help2man)
if(TRUNNION_BUILD_APPS)
  set(pages)
  foreach(app imu_calibrate imu_correct imu_live imu_navigate imu_replay gnss_attitude)
    if(NOT TARGET ${app})
      continue()
    endif()
    install(FILES ${PROJECT_SOURCE_DIR}/cmake/package/completion.bash RENAME ${app}
      DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions COMPONENT tools)
    if(NOT HELP2MAN_EXECUTABLE)
      continue()
    endif()
    set(page ${PROJECT_BINARY_DIR}/man/${app}.1)
    add_custom_command(OUTPUT ${page}
      COMMAND ${PROJECT_SOURCE_DIR}/cmake/package/man_pages ${HELP2MAN_EXECUTABLE} $<TARGET_FILE:${app}> ${PROJECT_BINARY_DIR}/man
      DEPENDS ${app} ${PROJECT_SOURCE_DIR}/cmake/package/man_pages VERBATIM)
    list(APPEND pages ${page})
  endforeach()
  if(pages)
    add_custom_target(man ALL DEPENDS ${pages})
    install(DIRECTORY ${PROJECT_BINARY_DIR}/man/ DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT tools)
  endif()
endif()

foreach(package trunnion=tools libtrunnion-dev=dev)
  string(REGEX MATCH "([^=]+)=(.+)" _ ${package})
  install(FILES ${PROJECT_SOURCE_DIR}/LICENSE RENAME copyright DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${CMAKE_MATCH_1} COMPONENT ${CMAKE_MATCH_2})
endforeach()
set(CPACK_PACKAGE_NAME trunnion)
set(CPACK_PACKAGE_VENDOR "the trunnion authors")
set(CPACK_PACKAGE_CONTACT "the trunnion authors <trunnion@example.org>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(CPACK_RESOURCE_FILE_LICENSE ${PROJECT_SOURCE_DIR}/LICENSE)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL tools dev)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_TOOLS_PACKAGE_NAME trunnion)
set(CPACK_DEBIAN_TOOLS_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_TOOLS_PACKAGE_RECOMMENDS gnuplot-nox)
set(CPACK_DEBIAN_DEV_PACKAGE_NAME libtrunnion-dev)
set(CPACK_DEBIAN_DEV_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEV_PACKAGE_DEPENDS
  "libeigen3-dev, libyaml-cpp-dev, libssl-dev, zlib1g-dev, libzstd-dev, liblz4-dev")
set(CPACK_DEBIAN_DEV_PACKAGE_RECOMMENDS "libceres-dev, liburdfdom-dev, liblcm-dev")
set(CPACK_COMPONENT_TOOLS_DESCRIPTION
  "Commands that calibrate an inertial unit on a two-axis table or by hand, correct its\n readings, navigate with them, and tell attitude from GNSS carrier phases.")
set(CPACK_COMPONENT_DEV_DESCRIPTION
  "Headers for firmware and hosts, static libraries and the CMake package of trunnion.")
include(CPack)
