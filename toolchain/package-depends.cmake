# Read by CPack while it makes packages: what they depend on, from the programs themselves.
set(here ${CMAKE_CURRENT_LIST_DIR})
function(find_depends out)
  execute_process(COMMAND ${here}/deb-depends ${ARGN}
                  OUTPUT_VARIABLE depends OUTPUT_STRIP_TRAILING_WHITESPACE RESULT_VARIABLE status)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "what the programs depend on could not be found out, see above")
  endif()
  set(${out} "${depends}" PARENT_SCOPE)
endfunction()

get_filename_component(build ${CPACK_PACKAGE_DIRECTORY} DIRECTORY)
find_depends(CPACK_DEBIAN_DAEMON_PACKAGE_DEPENDS ${build}/platform/daemon/zenithd)
set(CPACK_DEBIAN_DAEMON_PACKAGE_DEPENDS
    "systemd (>= 247), udev, init-system-helpers (>= 1.54), ${CPACK_DEBIAN_DAEMON_PACKAGE_DEPENDS}")
# The driver for libcamera is loaded where it is asked for.
if(EXISTS ${build}/lib/zenith/zenith-libcamera.so)
  find_depends(module_depends ${build}/lib/zenith/zenith-libcamera.so)
  string(REGEX MATCH "libcamera[^,]*" libcamera "${module_depends}")
  string(APPEND CPACK_DEBIAN_DAEMON_PACKAGE_RECOMMENDS ", ${libcamera}")
endif()
if(EXISTS ${build}/tools/zenith)
  find_depends(CPACK_DEBIAN_TOOLS_PACKAGE_DEPENDS ${build}/tools/zenith)
endif()
if(EXISTS ${build}/tools/ros2/zenith-ros2)
  find_depends(CPACK_DEBIAN_ROS2_PACKAGE_DEPENDS ${build}/tools/ros2/zenith-ros2)
  set(CPACK_DEBIAN_ROS2_PACKAGE_DEPENDS
      "systemd (>= 247), init-system-helpers (>= 1.54), ${CPACK_DEBIAN_ROS2_PACKAGE_DEPENDS}")
endif()
