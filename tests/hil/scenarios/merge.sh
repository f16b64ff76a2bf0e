#!/usr/bin/env bash
# Two robots with a camera, a CAN bus and a daemon each drive along one corridor in opposite directions
# and exchange their maps. They start at places that they do not know. Each must find the other's
# start, within 5 cm and half a degree of the truth.
# guests: x86 arm64
# limit: 400 s
set -uo pipefail
# shellcheck source=tests/hil/board/robot
source "$HIL_SOURCE/tests/hil/board/robot"

if ! "$HIL_BUILD/platform/daemon/zenithd" --print-config | grep '^\[radio\]' >/dev/null; then
  echo "merge: SKIPPED, NOTHING WAS TESTED: this zenithd cannot exchange maps"
  exit 77
fi

key=/run/fleet.key
(
  umask 077
  printf 'zenith-fleet-key 1\n%s\n' "$(head -c 32 /dev/urandom | od -An -tx1 | tr -d ' \n')" >"$key"
)
port_a=21475 port_b=21476
robot_config a radio.key_file="\"$key\"" radio.own_port=$port_a \
  radio.group='""' radio.peers="\"127.0.0.1:$port_b\""
robot_config b radio.key_file="\"$key\"" radio.own_port=$port_b \
  radio.group='""' radio.peers="\"127.0.0.1:$port_a\""
picture a
picture b
robot_start a
robot_start b
for robot in a b; do
  check "robot $robot sees" expect "$robot" 60 "pose.corners>10" health.can.up=true
done
drive a
drive b
for robot in a b; do
  check "robot $robot maps" expect "$robot" 120 "health.map.promoted>=50" "pose.inliers>=8" \
    "pose.error_m<0.1"
done
for robot in a b; do
  check "robot $robot holds the maps as one, at the right place" expect "$robot" 240 \
    alignment.state=merged "alignment.error_m<=0.05" "alignment.error_deg<=0.5"
done
for robot in a b; do
  check "robot $robot's peer light" light "$robot" peer 30 merged
  check "robot $robot knows where it is" expect "$robot" 30 "pose.error_m<0.1"
done
# What was right once must be right in the end, when all is seen.
played() { grep -q pictures "${robot_folder[$1]}/play"; }
for robot in a b; do
  check "robot $robot is at the end of its way" wait_for 200 played "$robot"
done
for robot in a b; do
  check "robot $robot still holds them so" expect "$robot" 30 \
    alignment.state=merged "alignment.error_m<=0.05" "alignment.error_deg<=0.5"
  printf '  figure: robot %s finds the other within (metres, degrees): %s\n' "$robot" \
    "$(value "$robot" alignment.error_m alignment.error_deg)"
done
finish
