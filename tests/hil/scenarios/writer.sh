#!/usr/bin/env bash
# One robot drives and maps what a program writes into its camera. The camera appears late, and on
# the way the program dies and comes back: once the camera gives nothing meanwhile, once its last
# picture again and again.
# guests: x86 arm64
# limit: 240 s
# quick: yes
set -uo pipefail
# shellcheck source=tests/hil/board/robot
source "$HIL_SOURCE/tests/hil/board/robot"

robot_config a
robot_start a
check "without pictures it is starting" expect a 20 health.state=starting health.camera.up=false
picture a
check "the camera appears late, and gives poses" expect a 30 "pose.corners>10" health.camera.up=true
drive a
check "it maps" expect a 90 "health.map.promoted>=50" "pose.inliers>=8" "pose.error_m<0.1"

check "its map so far" before_fault a
kill -KILL "${player[a]}"
# The loop-back device itself stays, and is opened again each time that no picture has come for long.
check "the program that writes the pictures dies: told" expect a 20 \
  "health.camera.stalled>=1" "health.camera.lost>=1"
picture a --since "$(<"${robot_folder[a]}/origin")"
check "it is back" recovers a
check "the pose goes on" expect a 60 "pose.error_m<0.1" "pose.inliers>=8"

check "the device is to repeat pictures" v4l2-ctl -d "${robot_camera[a]}" -c sustain_framerate=1
check "its map so far" before_fault a
kill -KILL "${player[a]}"
check "the program dies, and its last picture goes on: told" expect a 20 "health.camera.frozen>=3" \
  health.state=degraded
check "the log names it" wait_for 20 logged a "camera's picture is frozen"
check "the device repeats no more" v4l2-ctl -d "${robot_camera[a]}" -c sustain_framerate=0
picture a --since "$(<"${robot_folder[a]}/origin")"
check "it is back" recovers a
check "the pose goes on" expect a 60 "pose.error_m<0.1" "pose.inliers>=8"
finish
