# shellcheck shell=bash
# Debian's packages of any architecture and release, without a trace in the system's own apt; sourced,
# never run. They come from the archives that the system's apt names. debian_cache is the folder for
# apt's lists, debian_suite the release (bookworm, trixie; empty: the system's own). Every function
# returns 1 when it fails, with the reason on stderr.

debian_cache=${debian_cache:-build/apt}
debian_suite=${debian_suite:-}

# debian_own_suite: the name of the system's own release, such as bookworm.
debian_own_suite() { (. /etc/os-release && printf '%s\n' "${VERSION_CODENAME:-unknown}"); }

# debian_packages_of FILE...: the packages in lists with one a line and comments behind #.
debian_packages_of() { sed -e 's/#.*//' -e '/^[[:space:]]*$/d' "$@" | awk '{ print $1 }'; }

# debian_sources: one-line sources of the Debian archives that the system's apt uses. For another
# release they are the same archives under that release's name.
debian_sources() {
  # shellcheck disable=SC2016  # apt's fields, not the shell's variables
  local format='deb $(REPO_URI) $(RELEASE) $(COMPONENT)' lines
  lines=$(apt-get indextargets --format "$format" 'Created-By: Packages' 'Origin: Debian' | sort -u)
  [[ -n $lines ]] ||
    lines=$(apt-get indextargets --format "$format" 'Created-By: Packages' | sort -u)
  [[ -n $lines ]] || { echo "apt knows no archive of packages: see /etc/apt" >&2; return 1; }
  printf '%s\n' "$lines" | awk -v suite="$debian_suite" '
    suite != "" { sub(/^[^-]*/, suite, $3) }
    { print }'
}

# debian_apt ARCH apt-get|apt-cache ARGS...: apt for ARCH (amd64, arm64, armhf) with folders of its own.
debian_apt() {
  local arch=$1 program=$2 home=$debian_cache/$1
  shift 2
  "$program" -q -o APT::Architecture="$arch" -o APT::Architectures="$arch" \
    -o Dir::State="$home" -o Dir::State::status="$home/status" -o Dir::Cache="$home" \
    -o Dir::Etc::SourceList="$home/sources.list" -o Dir::Etc::SourceParts=- \
    -o APT::Sandbox::User="$(id -un)" -o Acquire::Languages=none "$@"
}

# debian_readable_sources ARCH: leaves out of ARCH's sources the archives whose lists cannot be had; a
# mirror that is being renewed, or that lacks ARCH in one of them. False when none is left.
debian_readable_sources() {
  local home=$debian_cache/$1 all line
  all=$(cat "$home/sources.list")
  while read -r line; do
    printf '%s\n' "$line" >"$home/sources.list"
    if debian_apt "$1" apt-get update >>"$home/update.log" 2>&1; then
      printf '%s\n' "$line"
    else
      echo "$1 DOES WITHOUT this archive, whose lists cannot be had (see $home/update.log): $line" >&2
    fi
  done <<<"$all" >"$home/readable.list"
  mv "$home/readable.list" "$home/sources.list"
  [[ -s $home/sources.list ]] && debian_apt "$1" apt-get update >>"$home/update.log" 2>&1
}

# debian_update ARCH: fetches the lists when there are none, or none of today.
debian_update() {
  local home=$debian_cache/$1
  if [[ -n $(find "$home/updated" -mmin -1440 2>/dev/null) ]]; then return 0; fi
  mkdir -p "$home/lists/partial" "$home/archives/partial"
  : >"$home/status"
  debian_sources >"$home/sources.list" || return 1
  if debian_apt "$1" apt-get update >"$home/update.log" 2>&1; then
    touch "$home/updated"
  elif [[ -e $home/updated ]]; then
    echo "apt's lists for $1 could not be updated; going on with older ones" >&2
  elif debian_readable_sources "$1"; then
    touch "$home/updated"
  else
    cat "$home/update.log" >&2
    return 1
  fi
}

# debian_unpack ARCH FOLDER PACKAGE...: downloads packages, not what they depend on, and unpacks
# them into FOLDER.
debian_unpack() {
  local arch=$1 folder=$2 debs deb
  shift 2
  mkdir -p "$folder"
  debs=$(mktemp -d)
  if ! (cd "$debs" && debian_apt "$arch" apt-get download "$@" >download.log 2>&1); then
    cat "$debs/download.log" >&2
    rm -rf "$debs"
    return 1
  fi
  for deb in "$debs"/*.deb; do dpkg-deb -x "$deb" "$folder"; done
  rm -rf "$debs"
}

# debian_bootstrap ARCH FOLDER PACKAGE...: unpacks packages and all that they depend on into the
# existing, empty FOLDER; runs none of their scripts.
debian_bootstrap() {
  local arch=$1 folder=$2 hooks=/usr/share/mmdebstrap/hooks/merged-usr options=()
  local packages suite log=$debian_cache/$1/bootstrap.log
  shift 2
  packages=$(IFS=,; echo "$*")
  debian_update "$arch" || return 1
  suite=$(awk '{ sub(/-.*/, "", $3); print $3; exit }' "$debian_cache/$arch/sources.list")
  if [[ -d $hooks ]]; then options=(--hook-dir="$hooks"); fi
  # A tar archive, so that it also works without root, in a user namespace.
  if ! mmdebstrap --quiet --variant=extract --architectures="$arch" --include="$packages" \
    --format=tar ${options[@]+"${options[@]}"} "$suite" - "$debian_cache/$arch/sources.list" 2>"$log" |
    tar -x -C "$folder" --no-same-owner --exclude='./dev/*'; then
    cat "$log" >&2
    return 1
  fi
}
