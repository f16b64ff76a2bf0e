# 64-bit ARM boards under Debian, from Cortex-A53 on. `./dev sysroot arm64` makes the sysroot.
set(zenith_architecture arm64)
set(zenith_emulator qemu-aarch64)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_LIBRARY_ARCHITECTURE aarch64-linux-gnu)
include(${CMAKE_CURRENT_LIST_DIR}/cross.cmake)
