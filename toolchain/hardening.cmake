# What Debian hardens its own programs with (dpkg-buildflags, hardening=+all), for every program and
# module of ours: position independent, read-only relocations bound at start, canaries on the stack,
# checked string functions. tests/system/hardening_test.cpp looks at the built files.
#
# Sanitizers bring checks of their own that these would hide.
if(NOT ZENITH_SANITIZE)
  add_compile_options(
    $<$<NOT:$<BOOL:$<TARGET_PROPERTY:POSITION_INDEPENDENT_CODE>>>:-fPIE>  # modules have -fPIC
    -fstack-protector-strong -fstack-clash-protection
    $<$<NOT:$<CONFIG:Debug>>:-U_FORTIFY_SOURCE> $<$<NOT:$<CONFIG:Debug>>:-D_FORTIFY_SOURCE=2>)
  add_link_options($<$<STREQUAL:$<TARGET_PROPERTY:TYPE>,EXECUTABLE>:-pie>
                   -Wl,-z,relro,-z,now,-z,noexecstack)
endif()
