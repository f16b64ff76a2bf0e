#!/usr/bin/env bash
# The guest's devices do what the drivers' tests rely on: cameras deliver, a fed camera returns what
# was fed, CAN frames arrive, a GPIO line that is set reads back.
# guests: x86 arm64
# limit: 60 s
set -euo pipefail

fail() { printf 'devices: %s\n' "$*" >&2; exit 1; }

grey_bytes=$((640 * 480))
work=$(mktemp -d)

echo "a vivid camera delivers five grey frames"
v4l2-ctl -d "$ZENITH_TEST_VIDEO" --set-fmt-video=width=640,height=480,pixelformat=GREY \
  --stream-mmap --stream-count=5 --stream-to="$work/vivid" >/dev/null 2>&1
[[ $(stat -c %s "$work/vivid") -eq $((5 * grey_bytes)) ]] || fail "vivid: $(ls -l "$work/vivid")"

echo "a loopback camera returns what is written into it"
head -c "$grey_bytes" "$work/vivid" >"$work/frame"
v4l2-ctl -d /dev/video42 --set-ctrl=keep_format=1 \
  --set-fmt-video-out=width=640,height=480,pixelformat=GREY
while cat "$work/frame"; do sleep 0.05; done | dd of=/dev/video42 bs="$grey_bytes" iflag=fullblock \
  status=none &
writer=$!
: >"$work/loop"
for ((i = 0; i < 100; i++)); do  # streaming is refused until the first frame was written
  [[ $(stat -c %s "$work/loop") -lt $((3 * grey_bytes)) ]] || break
  timeout 20 v4l2-ctl -d /dev/video42 --stream-mmap --stream-count=3 --stream-to="$work/loop" \
    >/dev/null 2>&1 || sleep 0.1
done
kill "$writer"
tail -c "$grey_bytes" "$work/loop" | cmp - "$work/frame" || fail "v4l2loopback changed the frame"

echo "a CAN frame arrives"
candump -n 1 -L "$ZENITH_TEST_CAN" >"$work/can" &
reader=$!
for ((i = 0; i < 100; i++)); do
  if ! kill -0 "$reader" 2>/dev/null; then break; fi
  cansend "$ZENITH_TEST_CAN" 311#0000002A0000002B
  sleep 0.1
done
wait "$reader"
grep -q '311#0000002A0000002B' "$work/can" || fail "CAN: $(cat "$work/can")"

echo "a GPIO line that is set reads back"
read -r chip line < <(gpiofind a-peer) || fail "no line is named a-peer"
gpioset --mode=signal "$chip" "$line=1" &
setter=$!
for ((i = 0; i < 100; i++)); do
  [[ $(<"$ZENITH_TEST_GPIO_SYSFS/sim_gpio$line/value") == 1 ]] && break
  sleep 0.1
done
[[ $(<"$ZENITH_TEST_GPIO_SYSFS/sim_gpio$line/value") == 1 ]] || fail "line a-peer stays low"
kill "$setter"
echo "devices: all there"
