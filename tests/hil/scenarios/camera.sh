#!/usr/bin/env bash
# A camera that appears late, is unplugged, and whose driver reports errors. It shows test pictures;
# the robot stands, so this is about the device alone.
# guests: x86 arm64
# limit: 240 s
set -uo pipefail
# shellcheck source=tests/hil/board/robot
source "$HIL_SOURCE/tests/hil/board/robot"

camera=$ZENITH_TEST_VIDEO
control() { v4l2-ctl -d "$camera" --set-ctrl="$1"; }

modprobe -r vivid
robot_config a camera.device="\"$camera\"" camera.rate_hz=2
robot_start a
stand a
check "no camera is there: it is starting" expect a 20 health.state=starting health.camera.up=false \
  health.can.up=true
modprobe vivid n_devs=2 node_types=0x1,0x1 num_inputs=1,1 input_types=0x0,0x0 vid_cap_nr=50,51
check "a camera is plugged in: poses" expect a 5 "pose.stamp_ns>$(now_ns)" health.camera.up=true
# Its stamps tell the end of the exposure, which it foretells: a stamp of the future is replaced.
check "stamps of the future are replaced" expect a 20 "health.camera.stamps_replaced>=2"
check "it stamps the start of the exposure" control timestamp_source=1

check "so far" before_fault a
check "unplugged and plugged in at once" control disconnect=1
check "it is used again" recovers a "health.camera.lost>${lost[a]}"

# As long as somebody holds it, vivid does not come back.
check "so far" before_fault a
exec 8<"$camera"
check "unplugged" control disconnect=1
check "it is missed" expect a 20 health.camera.up=false health.state=degraded
exec 8<&-
check "it is used again" recovers a "health.camera.lost>${lost[a]}"

check "so far" before_fault a
check "the stream fails for good" control inject_fatal_streaming_error=1
check "it is started again" recovers a "health.camera.lost>${lost[a]}"

check "so far" before_fault a
check "a buffer is flagged as damaged" control inject_v4l2_buf_flag_error=1
check "it is left out" recovers a "health.camera.damaged>=1" "health.camera.lost=${lost[a]}"

check "so far" before_fault a
check "the driver loses half of the pictures" control percentage_of_dropped_buffers=50
check "that is counted" expect a 60 "health.camera.lost_in_driver>=3"
check "it loses none" control percentage_of_dropped_buffers=0
check "all come" recovers a

check "so far" before_fault a
check "sequence numbers wrap" control wrap_sequence_number=1
check "nothing happens" recovers a "health.camera.lost=${lost[a]}"
check "they no longer wrap" control wrap_sequence_number=0
check "so far" before_fault a
check "stamps wrap" control wrap_timestamp=2
check "nothing happens" recovers a "health.camera.lost=${lost[a]}"
check "they no longer wrap" control wrap_timestamp=0

check "so far" before_fault a
check "no buffers can be had when the stream is opened again" control inject_vidioc_reqbufs_error=1
check "meanwhile it is unplugged" control disconnect=1
check "it is opened until that works" recovers a
finish
