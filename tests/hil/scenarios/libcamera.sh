#!/usr/bin/env bash
# A camera of libcamera: the whole daemon with the kernel's vimc, which is taken away and comes back.
# Without udev libcamera hears of neither, so it is the missing frames that tell.
# guests: x86
# limit: 180 s
set -uo pipefail
# shellcheck source=tests/hil/board/robot
source "$HIL_SOURCE/tests/hil/board/robot"
# shellcheck source=tests/hil/board/devices
source "$HIL_SOURCE/tests/hil/board/devices"

driver=/sys/bus/platform/drivers/vimc

robot_config a camera.driver='"libcamera"' camera.id="\"$ZENITH_TEST_LIBCAMERA\"" camera.rate_hz=2 \
  camera.first_frame_s=20 camera.stall_s=5
# vimc has sizes that are multiples of six.
sed -i -e 's/^\(width_px\|height_px\) = .*/\1 = 240/' -e 's/^\(cu_px\|cv_px\) = .*/\1 = 120/' \
  "${robot_folder[a]}/zenith.toml"
robot_start a
stand a
check "pictures and wheels: poses" expect a 60 "health.camera.frames>=5" health.camera.up=true \
  health.can.up=true "pose.stamp_ns>0"
check "its stamps are good" expect a 20 health.camera.stamps_replaced=0 health.camera.damaged=0
check "the log names the camera" logged a "libcamera .*$ZENITH_TEST_LIBCAMERA.*240x240"

check "the camera goes" eval "echo vimc.0 >$driver/unbind"
check "it is missed" expect a 40 health.camera.up=false "health.camera.lost>=1" \
  "health.camera.stalled>=1"
check "the log tells of it" wait_for 20 logged a "libcamera knows no camera here"
check "the camera comes back" eval "echo vimc.0 >$driver/bind"
check "udev knows of it" hil_tell_udev
# Its stream was not stopped: libcamera 0.0.3 would have ended the process by an assertion.
check "it is used again, by the same process" expect a 60 health.camera.up=true "health.camera.opened>=2" \
  health.camera.abandoned=1 "pose.stamp_ns>$(now_ns)"
finish
