#!/usr/bin/env bash
# The drivers' contracts on the guest's devices. A case that would be skipped has failed, but for
# pulling a camera out, which scenario "camera" does.
# guests: x86 arm64
# limit: 180 s
# quick: yes
set -uo pipefail

said=$(mktemp)
status=0
filter='*CameraContract.*:*CanBusContract.*:VirtualCan.*:GpiodLedsTest.*'
if [[ ! -e $HIL_BUILD/lib/zenith/zenith-libcamera.so ]]; then
  echo "libcamera: NOT TESTED: its driver was not built for this board"
  filter+=':-*Libcamera*'
fi
"$HIL_BUILD/tests/zenith_tests_drivers" --gtest_color=no \
  --gtest_filter="$filter" 2>&1 |
  tee "$said" | { grep -E '^\[  (FAILED|SKIPPED)|^\[  PASSED|Failure$|tests ran' || true; }
status=${PIPESTATUS[0]}
skipped=$(grep '^\[  SKIPPED \] .*)$' "$said" | grep -v 'PulledOutItIsLostUntilItIsOpenedAgain')
if [[ -n $skipped ]]; then
  printf 'drivers: these were not tested:\n%s\n' "$skipped"
  status=1
fi
# That the devices' own cases were there at all.
for suite in 'CameraContract.*V4l2OnKernel' 'CanBusContract.*Socket' 'VirtualCan\.' 'GpiodLedsTest\.'; do
  grep -q "^\[       OK \] .*$suite" "$said" || { echo "drivers: no case of $suite"; status=1; }
done
exit "$status"
