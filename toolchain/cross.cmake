# Cross-compiles for another architecture of Debian: read by arm64.cmake and armhf.cmake, which set
# zenith_architecture, zenith_emulator and CMAKE_LIBRARY_ARCHITECTURE.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_C_COMPILER ${CMAKE_LIBRARY_ARCHITECTURE}-gcc)
set(CMAKE_CXX_COMPILER ${CMAKE_LIBRARY_ARCHITECTURE}-g++)

cmake_path(GET CMAKE_CURRENT_LIST_DIR PARENT_PATH source_folder)
set(CMAKE_SYSROOT ${source_folder}/build/sysroot/${zenith_architecture})
if(NOT EXISTS ${CMAKE_SYSROOT}/usr/include)
  message(FATAL_ERROR "There is no sysroot in ${CMAKE_SYSROOT}. "
                      "Please run: ./dev sysroot ${zenith_architecture}")
endif()
# Libraries that only other libraries need are found too; some of Debian's lie in folders of their own.
set(library_folder ${CMAKE_SYSROOT}/usr/lib/${CMAKE_LIBRARY_ARCHITECTURE})
foreach(kind EXE SHARED MODULE)
  set(CMAKE_${kind}_LINKER_FLAGS_INIT
      "-Wl,-rpath-link,${library_folder}/blas -Wl,-rpath-link,${library_folder}/lapack")
endforeach()

set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)

# pkg-config looks into the sysroot alone.
set(ENV{PKG_CONFIG_SYSROOT_DIR} ${CMAKE_SYSROOT})
set(ENV{PKG_CONFIG_LIBDIR} ${library_folder}/pkgconfig:${CMAKE_SYSROOT}/usr/share/pkgconfig)

# Tests run here, too, under user-mode emulation, which also asks them for their cases while they are
# built. QEMU_CPU=cortex-a72 in the environment chooses the processor.
find_program(ZENITH_EMULATOR NAMES ${zenith_emulator}-static ${zenith_emulator})
if(ZENITH_EMULATOR)
  set(CMAKE_CROSSCOMPILING_EMULATOR ${ZENITH_EMULATOR} -L ${CMAKE_SYSROOT})
endif()
