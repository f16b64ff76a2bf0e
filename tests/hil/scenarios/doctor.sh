#!/usr/bin/env bash
# `zenith doctor` on real V4L2, CAN and GPIO devices: what is there is found, what is missing or
# wrong is told. Needs the host's build, which the x86 guest sees: build/dev/tools/zenith.
# guests: x86
# limit: 400 s
set -euo pipefail

fail() { printf 'doctor: %s\n' "$*" >&2; cat "$work/said" >&2; exit 1; }

zenith=${ZENITH:-$HIL_SOURCE/build/dev/tools/zenith}
work=$(mktemp -d)
[[ -x $zenith ]] || { : >"$work/said"; fail "$zenith is not built"; }

# configure CAMERA INTERFACE LED RATE: the daemon's configuration.
configure() {
  cat >"$work/zenith.toml" <<TOML
[camera]
device = "$1"
rate_hz = $4
[odometry]
can_interface = "$2"
[leds]
status = "$3"
[telemetry]
socket = "$work/telemetry.sock"
TOML
}

# examine CODE [OPTIONS]: runs it, and wants this exit code.
examine() {
  local status=0 wanted=$1
  shift
  "$zenith" doctor --config "$work/zenith.toml" --state "$work" --watch 8 "$@" >"$work/said" ||
    status=$?
  [[ $status -eq $wanted ]] || fail "exit code $status, expected $wanted"
}

# says PATTERN: a line of it fits.
says() { grep -qE -- "$1" "$work/said" || fail "no line fits: $1"; }

echo "all is there: a camera, wheels on the bus, a free GPIO line"
v4l2-ctl -d "$ZENITH_TEST_VIDEO" --set-fmt-video=width=640,height=480,pixelformat=GREY >/dev/null
(while :; do cansend "$ZENITH_TEST_CAN" 311#0000002A0000002B; sleep 0.01; done) &
sender=$!
configure "$ZENITH_TEST_VIDEO" "$ZENITH_TEST_CAN" gpio:a-status 5
examine 0
says '^ok    camera device +- /dev/video50'
says '^ok    camera format +- [A-Z0-9]+ 640x480'
says '^(ok|warn)  +camera rate +- [0-9.]+ frames'
says '^(ok|warn)  +camera stamps'
says '^(ok|warn)  +camera picture'
says "^ok    can interface +- $ZENITH_TEST_CAN is up"
says '^ok    can controller +- vcan'
says '^ok    can traffic .*0x311'
says '^(ok|warn)  +wheels +- [0-9]+ a second by agilex_v2, standing'
says '^ok    led status +- .*a-status.*free'
says '^skip  daemon '

echo "another program has the camera and the line"
gpioset --mode=signal "$(gpiofind a-status | cut -d' ' -f1)" "$(gpiofind a-status | cut -d' ' -f2)=1" &
setter=$!
v4l2-ctl -d "$ZENITH_TEST_VIDEO" --stream-mmap >/dev/null 2>&1 &
streamer=$!
for ((i = 0; i < 100; i++)); do
  status=0
  "$zenith" doctor --config "$work/zenith.toml" --state "$work" --watch 1 >"$work/said" || status=$?
  if [[ $status -eq 1 ]] && grep -q 'camera in use.*v4l2-ctl' "$work/said" &&
    grep -q '^FAIL  led status.*gpioset' "$work/said"; then break; fi
  sleep 0.2
done
says '^warn  camera in use .*v4l2-ctl'
says '^FAIL  led status .*gpioset'
says '^FAIL  camera rate'
kill "$setter" "$streamer"

echo "the base is silent"
kill "$sender"
wait "$sender" 2>/dev/null || true
examine 1
says '^FAIL  can traffic .*nothing came'

echo "the base speaks otherwise"
(while :; do cansend "$ZENITH_TEST_CAN" 123#00; sleep 0.05; done) &
sender=$!
examine 1
says '^FAIL  wheels .*0x311'
kill "$sender"

echo "the interface is down; the camera is a loop-back device that nobody feeds; no such line"
ip link set "$ZENITH_TEST_CAN_B" down
configure /dev/video44 "$ZENITH_TEST_CAN_B" gpio:no-such-line 5
examine 1 --fix-hints
says '^FAIL  can interface .*is down'
says '^ +sudo ip link set'
says '^FAIL  camera device .*does not capture'
says '^FAIL  led status .*no such line'

echo "nothing is there"
configure /dev/video99 can7 gpio:a-status 5
examine 1 --json
python3 - "$work/said" <<'PYTHON' 2>/dev/null || grep -q '"verdict": "fail"' "$work/said" || fail "no JSON"
import json, sys
assert json.load(open(sys.argv[1]))["failed"] >= 2
PYTHON
echo "doctor: every verdict as expected"
