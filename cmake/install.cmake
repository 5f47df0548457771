# SPDX-FileCopyrightText: 2026 the trunnion authors
# SPDX-License-Identifier: BSD-3-Clause

include(CMakePackageConfigHelpers)
get_property(TRUNNION_COMPONENTS GLOBAL PROPERTY TRUNNION_COMPONENTS)
set(destination ${CMAKE_INSTALL_LIBDIR}/cmake/trunnion)
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/trunnion-config.cmake.in
  ${PROJECT_BINARY_DIR}/trunnion-config.cmake INSTALL_DESTINATION ${destination})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/trunnion-config-version.cmake COMPATIBILITY SameMinorVersion)
file(RELATIVE_PATH TRUNNION_PREFIX_FROM_PC /p/${CMAKE_INSTALL_LIBDIR}/pkgconfig /p)
configure_file(${CMAKE_CURRENT_LIST_DIR}/trunnion-core.pc.in ${PROJECT_BINARY_DIR}/trunnion-core.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/trunnion-config.cmake ${PROJECT_BINARY_DIR}/trunnion-config-version.cmake
  ${CMAKE_CURRENT_LIST_DIR}/FindLcm.cmake ${CMAKE_CURRENT_LIST_DIR}/FindCompression.cmake DESTINATION ${destination} COMPONENT dev)
install(FILES ${PROJECT_BINARY_DIR}/trunnion-core.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT dev)
