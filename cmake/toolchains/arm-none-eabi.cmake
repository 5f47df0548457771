# SPDX-FileCopyrightText: 2026 the trunnion authors
# SPDX-License-Identifier: BSD-3-Clause

# Cortex-M by GCC for bare metal. TRUNNION_BOARD names the processor and the machine that QEMU runs it on.
set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR arm)
set(CMAKE_CXX_COMPILER arm-none-eabi-g++)
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)
set(TRUNNION_BOARD m4f CACHE STRING "m0plus, m3, m4f, m7 or m55")
list(APPEND CMAKE_TRY_COMPILE_PLATFORM_VARIABLES TRUNNION_BOARD)

set(cpu_m0plus "-mcpu=cortex-m0plus -mfloat-abi=soft")
set(cpu_m3 "-mcpu=cortex-m3 -mfloat-abi=soft")
set(cpu_m4f "-mcpu=cortex-m4 -mfloat-abi=hard -mfpu=fpv4-sp-d16")
set(cpu_m7 "-mcpu=cortex-m7 -mfloat-abi=hard -mfpu=fpv5-sp-d16")
set(cpu_m55 "-mcpu=cortex-m55 -mfloat-abi=hard")
if(NOT DEFINED cpu_${TRUNNION_BOARD})
  message(FATAL_ERROR "TRUNNION_BOARD is '${TRUNNION_BOARD}'; known are m0plus, m3, m4f, m7 and m55.")
endif()
set(CMAKE_CXX_FLAGS_INIT "${cpu_${TRUNNION_BOARD}} -mthumb -fno-exceptions -fno-rtti -fno-threadsafe-statics -fno-unwind-tables \
-fno-asynchronous-unwind-tables -fno-use-cxa-atexit -fno-math-errno -ffunction-sections -fdata-sections")
set(CMAKE_EXE_LINKER_FLAGS_INIT "-nostartfiles --specs=nano.specs -Wl,--gc-sections -Wl,--fatal-warnings")
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
