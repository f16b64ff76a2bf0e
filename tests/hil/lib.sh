# shellcheck shell=bash
# What the scripts of the emulated boards share; sourced, never run. Sets hil_source (the sources)
# and hil_build (where everything made lies).

hil_source=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd -P)
# shellcheck disable=SC2034  # for those who source this
hil_build=$hil_source/build/hil

readonly HIL_SKIP=77  # exit code: no guest can run here; the caller says so and goes on

hil_say() { printf '== %s\n' "$*" >&2; }
hil_die() { printf '%s: %s\n' "${0##*/}" "$*" >&2; exit 1; }
hil_skip() {
  printf '\n%s: SKIPPED, NOTHING WAS TESTED: %s\n\n' "${0##*/}" "$*" >&2
  exit "$HIL_SKIP"
}

# hil_need PROGRAM...: skips when one is not installed.
hil_need() {
  local program
  for program in "$@"; do
    command -v "$program" >/dev/null || [[ -x /usr/sbin/$program || -x /sbin/$program ]] ||
      hil_skip "the program '$program' is missing; './dev hil' installs tests/hil/packages.txt"
  done
}
