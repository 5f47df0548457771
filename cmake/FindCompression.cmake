# SPDX-FileCopyrightText: 2026 the trunnion authors
# SPDX-License-Identifier: BSD-3-Clause

# Compression::zstd and Compression::lz4: Debian's come without CMake packages, and those of others differ in their names.
find_library(ZSTD_LIBRARY zstd)
find_path(ZSTD_INCLUDE_DIR zstd.h)
find_library(LZ4_LIBRARY lz4)
find_path(LZ4_INCLUDE_DIR lz4frame.h)
mark_as_advanced(ZSTD_LIBRARY ZSTD_INCLUDE_DIR LZ4_LIBRARY LZ4_INCLUDE_DIR)
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(Compression REQUIRED_VARS ZSTD_LIBRARY ZSTD_INCLUDE_DIR LZ4_LIBRARY LZ4_INCLUDE_DIR)
foreach(name zstd lz4)
  if(Compression_FOUND AND NOT TARGET Compression::${name})
    string(TOUPPER ${name} variable)
    add_library(Compression::${name} UNKNOWN IMPORTED)
    set_target_properties(Compression::${name} PROPERTIES
      IMPORTED_LOCATION ${${variable}_LIBRARY} INTERFACE_INCLUDE_DIRECTORIES ${${variable}_INCLUDE_DIR})
  endif()
endforeach()
