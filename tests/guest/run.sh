#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# run.sh GUEST LIMIT_S SHARED -- PROGRAM [ARGUMENT...]: runs a program of this computer as root in the guest that set_up.sh made,
# on the files of this computer (read-only; what is written stays in the guest's memory, but for /run/shared, which is the
# folder SHARED). Exit code: the program's; 124: not done after LIMIT_S seconds; 125: the guest itself failed; 77: no QEMU.
#
# One processor whose time is the number of its instructions, idle time being skipped: the same result on any computer
# under any load. Times that the guest measures are therefore no performance of any machine.
set -eu

guest=$1 limit_s=$2 shared=$3
shift 4
say() { printf 'guest: %s\n' "$*" >&2; }

if ! command -v qemu-system-x86_64 >/dev/null 2>&1; then
  say "SKIPPED: qemu-system-x86_64 is not installed, so no kernel of GPIO and cameras was tried. Debian: qemu-system-x86"
  exit 77
fi
[ -f "$guest/vmlinuz" ] && [ -f "$guest/initramfs.cpio" ] || { say "$guest is no guest: run set_up.sh first"; exit 125; }

rm -rf "$shared"
mkdir -p "$shared"
{ echo "$1"; ldd "$1" | sed -n 's/^[^/]*\(\/[^ ]*\).*/\1/p'; } | xargs readlink -f >"$shared/files"
{
  echo 'export PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LC_ALL=C.UTF-8'
  echo 'cd /run/shared'
  printf 'exec'
  for word in "$@"; do printf " '%s'" "$(printf '%s' "$word" | sed "s/'/'\\\\''/g")"; done
  echo
} >"$shared/job"

# Never KVM: time would be the host's. (And where /dev/kvm is a nested one without vmx or svm, this kernel does not boot.)
qemu=0
timeout -k 5 "$limit_s" qemu-system-x86_64 -M q35 -accel tcg,thread=single -cpu max -icount shift=${GUEST_SHIFT:-1},sleep=off -smp 1 -m ${GUEST_MB:-384} \
  -nodefaults -no-user-config -display none -no-reboot -monitor none \
  -kernel "$guest/vmlinuz" -initrd "$guest/initramfs.cpio" -append 'console=ttyS0 quiet loglevel=4 panic=-1 mitigations=off' \
  -serial "file:$shared/console" \
  -virtfs local,path=/,mount_tag=host,security_model=none,readonly=on,multidevs=remap \
  -virtfs "local,path=$shared,mount_tag=shared,security_model=none,multidevs=remap" || qemu=$?

[ ! -f "$shared/log" ] || cat "$shared/log"
if [ -f "$shared/exit_code" ]; then
  code=$(cat "$shared/exit_code")
  [ "$code" = 0 ] || { say 'the guest said:'; cat "$shared/console" >&2; }
  exit "$code"
fi
say 'the guest said:'
cat "$shared/console" >&2 || :
if [ $qemu = 124 ] || [ $qemu = 137 ]; then
  say "not done after $limit_s s"
  exit 124
fi
say "the guest failed (QEMU: $qemu)"
exit 125
