#!/usr/bin/env bash
# `zenith calibrate lens --camera`: pictures of a board, made by `zenith calibrate sample`, are shown to
# a V4L2 camera one after the other, as by somebody who holds the board still and moves on. The lens
# that is found is held against the one that the pictures were made with.
# guests: x86
# limit: 600 s
set -uo pipefail
# shellcheck source=tests/hil/board/robot
source "$HIL_SOURCE/tests/hil/board/robot"

zenith=${ZENITH:-$HIL_SOURCE/build/dev/tools/zenith}
camera=/dev/video42
work=$HIL_RESULTS/$scenario
mkdir -p "$work"
cd "$work" || exit 1

check "pictures of a board" "$zenith" calibrate sample --out views
views=(views/*.png)

# A recording of them: hil-cut makes grey pictures of it, as a camera delivers them.
mkdir -p rec/mav0/cam0/data
cp "${views[@]}" rec/mav0/cam0/data
cat >rec/robot.toml <<'TOML'
[wheels]
track_width_m = 0.4
left_scale = 1.0
right_scale = 1.0
[odometry]
codec = "agilex_v2"
can_interface = "can0"
TOML
cat >rec/mav0/cam0/sensor.yaml <<'YAML'
T_BS: {cols: 4, rows: 4, data: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0.3, 0, 0, 0, 1]}
rate_hz: 1
resolution: [640, 480]
intrinsics: [150, 150, 320, 240]
distortion_model: equidistant
distortion_coefficients: [0, 0, 0, 0]
YAML
stamp=1
for view in "${views[@]}"; do
  printf '%d000000000,%s\n' "$stamp" "$(basename "$view")"
  printf '%d 0 0 0 0 0 0 1\n' "$stamp" >>rec/groundtruth.tum
  stamp=$((stamp + 1))
done >rec/mav0/cam0/data.csv
for ((i = 0; i <= stamp; i++)); do printf '(%d.000000) can0 311#0000002A0000002B\n' "$i"; done >rec/can0.log
check "the pictures as a camera delivers them" "$hil_programs/hil-cut" rec play 0 10000 1

# Each is shown for three seconds, again and again.
show() {
  local i k
  while :; do
    for ((i = 0; i < ${#views[@]}; i++)); do
      for ((k = 0; k < 6; k++)); do
        dd if=play/frames.grey of="$camera" bs=307200 skip="$i" count=1 status=none
        sleep 0.5
      done
    done
  done
}
check "a camera" v4l2-ctl -d "$camera" --set-ctrl keep_format=1 \
  --set-fmt-video-out width=640,height=480,pixelformat=GREY
show &
shown=$!

zenithd=$HIL_BUILD/platform/daemon/zenithd
"$zenithd" --print-config >zenith.toml
started=$(now_ns)
check "the lens is calibrated from the live camera" \
  "$zenith" calibrate lens --camera "$camera" --out lens --write zenith.toml
printf '          after %d s of the guest\n' $((($(now_ns) - started) / 1000000000))
kill "$shown"
v4l2-ctl -d "$camera" --set-ctrl keep_format=0  # as other scenarios expect it

taken=(lens/views/*.png)
check "it took at least twenty views" test "${#taken[@]}" -ge 20
check "and judged them good" grep -q '^verdict: good' lens/report.txt

# value KEY FILE: the number behind it.
value() { sed -n "s/^$1 = \([-0-9.e]*\).*/\1/p" "$2"; }
# near WHAT FOUND TRUE MOST
near() {
  awk -v a="$2" -v b="$3" -v most="$4" \
    'BEGIN { d = a - b; if (d < 0) d = -d; printf "%s %s, true %s\n", "'"$1"'", a, b; exit !(d <= most) }'
}
read -r fu _ cu cv < <(sed -n 's/^intrinsics: \[\(.*\)\].*/\1/p' views/truth.yaml | tr -d ',')
check "the focal length that it wrote, within 0.3 %" \
  near fu_px "$(value fu_px zenith.toml)" "$fu" "$(awk -v f="$fu" 'BEGIN { print f * 0.003 }')"
check "the centre, within a pixel" near cu_px "$(value cu_px zenith.toml)" "$cu" 1
check "the centre, within a pixel" near cv_px "$(value cv_px zenith.toml)" "$cv" 1

# A camera that shows no board, and one that shows nothing.
check "without pictures it says so, and ends" bash -c \
  "! '$zenith' calibrate lens --camera /dev/video44 --out none 2>none.log && ! test -e none && cat none.log"
finish
