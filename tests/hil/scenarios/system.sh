#!/usr/bin/env bash
# One robot drives and maps while the system plays tricks on it: steps of the wall clock, a process
# that is stopped and goes on, no memory, no CPU, a wrong configuration.
# guests: x86 arm64
# limit: 300 s
set -uo pipefail
# shellcheck source=tests/hil/board/robot
source "$HIL_SOURCE/tests/hil/board/robot"

robot_config a
picture a --send-can
robot_start a
check "it sees" expect a 30 "pose.corners>10" health.can.up=true
begin a
check "it maps" expect a 90 "health.map.promoted>=50" "pose.inliers>=8" "pose.error_m<0.1"

# step_clock SECONDS
step_clock() { date -s "@$(($(date +%s) + $1))"; }

check "its map so far" before_fault a
check "the clock jumps an hour ahead" step_clock 3600
check "nothing happens, for a second" expect a 5 "pose.stamp_ns>$(in_ns 1)" "pose.error_m<0.1"
check "the map stays" recovers a "pose.inliers>=8"
check "the clock jumps two days back" step_clock -172800
check "nothing happens, for a second" expect a 5 "pose.stamp_ns>$(in_ns 1)" "pose.error_m<0.1"
check "the map stays" recovers a "pose.inliers>=8" health.camera.lost=0 health.can.lost=0

check "its map so far" before_fault a
kill -STOP "${robot_pid[a]}"
sleep 3  # the fault itself: so long nothing runs
kill -CONT "${robot_pid[a]}"
check "stopped for three seconds, it goes on" recovers a
check "the pose goes on" expect a 60 "pose.error_m<0.1" "pose.inliers>=8"

check "its map so far" before_fault a
echo "[slam]
particels = 3" >>"${robot_folder[a]}/zenith.toml"
kill -HUP "${robot_pid[a]}"
check "a wrong configuration: refused" wait_for 20 logged a "the configuration stays as it was"
check "it goes on" recovers a "pose.error_m<0.1"

check "its map so far" before_fault a
busy=()
for ((i = 0; i < 2 * $(nproc); i++)); do
  while :; do :; done &
  busy+=("$!")
done
check "three seconds long all CPUs are busy: poses come" expect a 20 "pose.stamp_ns>$(in_ns 3)"
kill "${busy[@]}"
check "they are idle again" recovers a
check "the pose goes on" expect a 60 "pose.error_m<0.1" "pose.inliers>=8"

# All memory that there is, by a process that the kernel kills first.
check "its map so far" before_fault a
fill_memory() {
  local status=0
  "$hil_programs/hil-fill" || status=$?
  [[ $status -eq 137 ]] || { echo "exit code $status, not killed"; return 1; }
}
check "memory is exhausted, until the kernel kills a process" fill_memory
check "it goes on" recovers a
check "the pose goes on" expect a 60 "pose.error_m<0.1" "pose.inliers>=8"
finish
