#!/usr/bin/env bash
# What the lights show, read from the other side of the GPIO chip, in all states that one robot has.
# guests: x86 arm64
# limit: 240 s
# quick: yes
set -uo pipefail
# shellcheck source=tests/hil/board/robot
source "$HIL_SOURCE/tests/hil/board/robot"

modprobe -r vivid
robot_config a camera.device="\"$ZENITH_TEST_VIDEO\"" camera.rate_hz=2
robot_start a
check "without wheels and pictures: starting" light a status 14 starting
check "without wheels and pictures for long: fault" light a status 60 fault
check "the fault light agrees" light a fault 20 fault
check "the peer light is dark" light a peer 20 dark
modprobe vivid n_devs=2 node_types=0x1,0x1 num_inputs=1,1 input_types=0x0,0x0 vid_cap_nr=50,51
stand a
check "wheels and pictures: mapping" light a status 60 mapping
check "the fault light is dark" light a fault 20 dark
kill "${stander[a]}"
check "without wheels: degraded" light a status 20 degraded
check "the fault light agrees" light a fault 20 degraded
stand a
check "wheels again: mapping" light a status 20 mapping
kill -TERM "${robot_pid[a]}"
check "ended: dark" light a status 30 dark
unset "robot_pid[a]"
finish
