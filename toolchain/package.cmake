# Debian packages, made by CPack: `./dev package`. zenith is the daemon, with what systemd and udev
# need to know of it; zenith-tools is the command line tool; zenith-ros2, where Cyclone DDS is, the
# bridge to ROS 2.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME zenith)
# 0.1.0+deb12, 0.1.0+deb13: a package is for the release whose libraries it was linked with, and that
# of the later release is the newer one.
set(CPACK_DEBIAN_PACKAGE_VERSION ${ZENITH_PACKAGE_VERSION})
set(CPACK_PACKAGE_CONTACT "The Zenith maintainers <maintainers@zenith.invalid>")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_PACKAGE_DIRECTORY ${PROJECT_BINARY_DIR}/packages)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL daemon)
if(ZENITH_TOOLS)
  list(APPEND CPACK_COMPONENTS_ALL tools)
endif()
if(TARGET zenith-ros2)
  list(APPEND CPACK_COMPONENTS_ALL ros2)
endif()
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
# What the programs are linked with is found out when the packages are made.
set(CPACK_PROJECT_CONFIG_FILE ${CMAKE_CURRENT_LIST_DIR}/package-depends.cmake)

set(architecture_arm64 arm64)
set(architecture_aarch64 arm64)
set(architecture_x86_64 amd64)
set(architecture_arm armhf)
set(architecture_armv7l armhf)
set(CPACK_DEBIAN_PACKAGE_ARCHITECTURE ${architecture_${CMAKE_SYSTEM_PROCESSOR}})

set(CPACK_DEBIAN_DAEMON_PACKAGE_NAME zenith)
set(CPACK_DEBIAN_DAEMON_PACKAGE_SECTION science)
set(CPACK_DEBIAN_DAEMON_PACKAGE_RECOMMENDS zenith-tools)
set(CPACK_COMPONENT_DAEMON_DESCRIPTION
"A robot with one camera that looks at the ceiling and with wheel odometry on
CAN builds a map, exchanges it with other robots over UDP, encrypted, and
joins their maps with its own when it is sure. This package has the daemon,
its unit for systemd, its configuration and its rules for devices.")
set(maintainer_scripts ${PROJECT_SOURCE_DIR}/systemd/package)
set(CPACK_DEBIAN_DAEMON_PACKAGE_CONTROL_EXTRA
  ${maintainer_scripts}/postinst ${maintainer_scripts}/prerm ${maintainer_scripts}/postrm
  ${maintainer_scripts}/conffiles)

set(CPACK_DEBIAN_TOOLS_PACKAGE_NAME zenith-tools)
set(CPACK_DEBIAN_TOOLS_PACKAGE_SECTION science)
set(CPACK_DEBIAN_TOOLS_PACKAGE_SUGGESTS zenith)
set(CPACK_COMPONENT_TOOLS_DESCRIPTION
"zenith diagnoses a robot, makes the key of a fleet, records what a robot sees,
maps recordings, and simulates robots for whoever has none.")

set(CPACK_DEBIAN_ROS2_PACKAGE_NAME zenith-ros2)
set(CPACK_DEBIAN_ROS2_PACKAGE_SECTION science)
set(CPACK_DEBIAN_ROS2_PACKAGE_RECOMMENDS zenith)
set(CPACK_COMPONENT_ROS2_DESCRIPTION
"zenith-ros2 publishes what the daemon tells of its robot as topics of ROS 2,
over Cyclone DDS: odometry, pose, transforms, the map as a point cloud, other
robots' maps, and diagnostics. ROS 2 itself is not needed on the robot.")
set(CPACK_DEBIAN_ROS2_PACKAGE_CONTROL_EXTRA
  ${maintainer_scripts}-ros2/postinst ${maintainer_scripts}-ros2/prerm
  ${maintainer_scripts}-ros2/postrm ${maintainer_scripts}-ros2/conffiles)

include(CPack)
