#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# bare_root.sh FOLDER DEB... -- COMMAND...: makes a bare Debian 12 in FOLDER (debootstrap, minbase) unless there is one, installs the packages
# there by apt, runs the command in it as a user, removes the packages again and says what they have left. Needs root and Debian's packages.
# Exit code: the command's, or 70 if it could not be tried, or 71 if something is left.
set -eu
folder=$1
shift
packages=$(mktemp -d)
while [ "$1" != -- ]; do
  cp "$1" "$packages/"
  shift
done
shift

# Nothing that is mounted outlives the mount namespace.
if [ "${KERFBENCH_BARE_ROOT_INSIDE:-}" != yes ]; then
  KERFBENCH_BARE_ROOT_INSIDE=yes exec unshare --mount -- "$0" "$folder" "$packages"/*.deb -- "$@"
fi
say() { printf 'bare root: %s\n' "$*" >&2; }
in_root() { chroot "$folder" /usr/bin/env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root DEBIAN_FRONTEND=noninteractive LC_ALL=C.UTF-8 "$@"; }

mirror=${KERFBENCH_DEBIAN_MIRROR:-http://deb.debian.org/debian}
if [ ! -x "$folder/usr/bin/dpkg" ]; then
  say "debootstrap, minbase, from $mirror"
  debootstrap --variant=minbase bookworm "$folder" "$mirror" >"$packages/log" 2>&1 || { tail -n 5 "$packages/log" >&2; exit 70; }
fi
# What this computer reaches Debian by.
cp /etc/resolv.conf "$folder/etc/" 2>/dev/null || true
if [ -n "$(ls /etc/apt/apt.conf.d 2>/dev/null)" ]; then cp /etc/apt/apt.conf.d/*proxy* "$folder/etc/apt/apt.conf.d/" 2>/dev/null || true; fi
mount -t proc proc "$folder/proc"
mount --bind /dev "$folder/dev"
in_root sh -c 'getent passwd user >/dev/null || useradd --create-home user'
# State of the packages that are installed, and all files but those of apt and dpkg themselves.
state() { in_root find / -xdev \( -path /proc -o -path /dev -o -path /var/cache -o -path /var/lib/apt -o -path /var/lib/dpkg -o -path /var/log -o -path /home -o -path /tmp \) -prune -o -print | sort; }

in_root apt-get update -q >"$packages/log" 2>&1 || { tail -n 5 "$packages/log" >&2; exit 70; }
# What the packages need stays in the end: only they themselves are looked at.
mkdir -p "$folder/tmp/packages"
cp "$packages"/*.deb "$folder/tmp/packages/"
names=$(for each in "$packages"/*.deb; do dpkg-deb -f "$each" Package; done)
needs=$(for each in "$packages"/*.deb; do dpkg-deb -f "$each" Depends; done | tr ',' '\n' | sed 's/ *(.*//; s/^ *//' | sort -u | grep -v '^kerfbench' || true)
needs="$needs python3"
say "what they need"
# shellcheck disable=SC2086
in_root apt-get install -q -y --no-install-recommends $needs >"$packages/log" 2>&1 || { tail -n 20 "$packages/log" >&2; exit 70; }
state >"$packages/before"
say "install.sh"
# By the step of the CI templates; in the folder, apt-get install ./kerfbench_*.deb does the same.
cp "$(dirname "$0")/ci/install.sh" "$folder/tmp/packages/"
in_root sh -c 'cd /tmp/packages && ./install.sh ./*.deb' >"$packages/log" 2>&1 || { tail -n 20 "$packages/log" >&2; exit 70; }
code=0
say "$*"
chroot --userspec=user:user "$folder" /usr/bin/env -i PATH=/usr/bin:/bin HOME=/home/user LC_ALL=C.UTF-8 CI=true sh -c 'cd && "$@"' sh "$@" || code=$?
# shellcheck disable=SC2086
in_root apt-get purge -q -y $names >"$packages/log" 2>&1 || { tail -n 20 "$packages/log" >&2; exit 70; }
state >"$packages/after"
if ! cmp -s "$packages/before" "$packages/after"; then
  say "left behind, or gone, after apt-get purge:"
  diff "$packages/before" "$packages/after" >&2 || true
  [ "$code" -ne 0 ] || code=71
fi
rm -rf "$packages" "$folder/tmp/packages"
exit "$code"
