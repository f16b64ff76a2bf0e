#!/usr/bin/env bash
# Usage: no_shared_symbols.sh OBJECT...
# Objects that were compiled for an instruction set must not define anything that the linker shares
# between files (inline functions, templates): it might take their copy for the whole program, which then
# ends with an illegal instruction on processors that lack it. Exit code 77: there is no nm.
set -euo pipefail
command -v nm >/dev/null || { echo "SKIPPED, nothing was tested: there is no nm"; exit 77; }
status=0 seen=0
for object in "$@"; do
  [[ $object =~ _(sse41|avx2|avx512|neon|neon_dotprod)\.cpp\.o$ ]] || continue
  seen=$((seen + 1))
  if shared=$(nm -C --defined-only "$object" | grep -E '^[0-9a-f]* [WVuwv] '); then
    printf '%s shares with other files:\n%s\n' "$object" "$shared"
    status=1
  fi
done
printf '%d objects looked at\n' "$seen"
[[ $seen -gt 0 ]] || { echo "there is no object of any instruction set"; exit 1; }
exit "$status"
