# Every target of ours links zenith_warnings; other people's headers are SYSTEM includes.
add_library(zenith_warnings INTERFACE)
target_compile_options(zenith_warnings INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion
  -Wnon-virtual-dtor -Woverloaded-virtual -Wformat=2 -Wimplicit-fallthrough
  -Wno-restrict)  # gcc 12 sees overlaps in std::string that are not there (GCC bug 105651)
if(CMAKE_SYSTEM_PROCESSOR MATCHES "^arm")
  target_compile_options(zenith_warnings INTERFACE -Wno-psabi)  # notes on changes in gcc 7
endif()
if(ZENITH_WERROR)
  target_compile_options(zenith_warnings INTERFACE -Werror)
endif()
