# shellcheck shell=bash
# What the scripts of the emulated board with an installed system share; sourced, never run.
# shellcheck source=tests/hil/lib.sh
source "$(dirname "${BASH_SOURCE[0]}")/../hil/lib.sh"

# shellcheck disable=SC2034  # for those who source this
board_folder=$hil_source/tests/board
# shellcheck disable=SC2034
board_build=$hil_source/build/board

# board_first_files FOLDER KERNEL BUSYBOX: the first file system, FOLDER/first.cpio.
board_first_files() {
  local files=$1/first kernel=$2 release name file
  release=$(<"$kernel/release")
  mkdir -p "$files/bin" "$files/lib"
  cp "$3/busybox" "$files/bin/busybox"
  cp "$board_folder/guest/init" "$files/init"
  cp "$kernel/boot-modules" "$files"
  for name in virtio_blk ext4; do
    modprobe -d "$kernel" -S "$release" --show-depends "$name" |
      sed -n "s|^insmod $kernel/\([^ ]*\).*|\1|p"
  done >>"$files/boot-modules"
  awk '!seen[$0]++' "$files/boot-modules" >"$1/boot-modules"
  mv "$1/boot-modules" "$files/boot-modules"
  while read -r file; do
    mkdir -p "$files/${file%/*}"
    cp "$kernel/$file" "$files/$file"
  done <"$files/boot-modules"
  (cd "$files" && find . | cpio -o -H newc --quiet) >"$1/first.cpio"
}

# board_boot DISK RESULTS [WORD...]: one life of the board, until it is switched off. WORDs go
# to the kernel. What the board says comes out. Its clock counts instructions, one a nanosecond, as that
# of the guests of tests/hil.
board_boot() {
  local disk=$1 results=$2 folders kernel busybox work status=0
  shift 2
  folders=$("$hil_source/tests/hil/prepare" arm64)
  { read -r kernel; read -r busybox; } <<<"$folders"
  work=$(mktemp -d)
  board_first_files "$work" "$kernel" "$busybox"
  local share=local,security_model=none,multidevs=remap
  timeout -k 5 "${BOARD_TIME_LIMIT:-3600}" qemu-system-aarch64 \
    -M virt,gic-version=3 -cpu cortex-a72 -accel tcg -icount "shift=${HIL_SHIFT:-0}" -rtc clock=vm \
    -smp 1 -m 1536 -display none -nodefaults -no-reboot -nic none \
    -kernel "$kernel/kernel" -initrd "$work/first.cpio" \
    -drive "file=$disk,format=raw,if=virtio,cache=writeback" \
    -virtfs "$share,path=$hil_source,mount_tag=source,readonly=on" \
    -virtfs "$share,path=$results,mount_tag=results" \
    -chardev "file,id=log,path=$results/kernel.log" -serial chardev:log \
    -device virtio-serial-pci -chardev file,id=out,path=/dev/stdout \
    -device virtserialport,chardev=out,name=board.out -device virtio-rng-pci \
    -append "console=ttyAMA0 quiet panic=-1 printk.devkmsg=on rdinit=/init \
board.modules=${kernel#"$hil_source"/}/lib/modules $*" </dev/null | cat || status=${PIPESTATUS[0]}
  rm -rf "$work"
  return "$status"
}
