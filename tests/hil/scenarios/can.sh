#!/usr/bin/env bash
# One robot drives and maps; on the way the interface of its CAN bus goes down and up, and its
# controller leaves the bus and comes back.
# guests: x86 arm64
# limit: 240 s
set -uo pipefail
# shellcheck source=tests/hil/board/robot
source "$HIL_SOURCE/tests/hil/board/robot"

robot_config a
picture a --send-can
robot_start a
check "it sees" expect a 30 "pose.corners>10" health.can.up=true
begin a
check "it maps" expect a 90 "health.map.promoted>=50" "pose.inliers>=8" "pose.error_m<0.1"

check "its map so far" before_fault a
ip link set vcan0 down
check "the interface goes down: told" expect a 20 health.can.up=false
ip link set vcan0 up
check "it is up again" recovers a
check "the pose goes on" expect a 60 "pose.error_m<0.1" "pose.inliers>=8"

# What the controller's driver would tell. The base is silent, as it is on a bus that is off.
check "its map so far" before_fault a
kill -STOP "${player[a]}"
cansend vcan0 20000040#0000000000000000
check "bus-off: told" expect a 20 health.can.bus_off=true
cansend vcan0 20000100#0000000000000000
kill -CONT "${player[a]}"
check "the controller has restarted" recovers a health.can.bus_off=false
check "the pose goes on" expect a 60 "pose.error_m<0.1" "pose.inliers>=8"
finish
