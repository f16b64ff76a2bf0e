# 32-bit ARM boards under Debian: ARMv7-A with VFPv3-D16, so without NEON but in the files of kernels
# that are chosen at run time. `./dev sysroot armhf` makes the sysroot.
set(zenith_architecture armhf)
set(zenith_emulator qemu-arm)
set(CMAKE_SYSTEM_PROCESSOR armv7l)
set(CMAKE_LIBRARY_ARCHITECTURE arm-linux-gnueabihf)
include(${CMAKE_CURRENT_LIST_DIR}/cross.cmake)
