#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# set_up.sh FOLDER: makes FOLDER with vmlinuz and initramfs.cpio, a guest of Debian's own kernel for run.sh. The kernel comes
# from Debian's packages, unpacked and not installed; gpio-sim, which Debian leaves out, and v4l2loopback are built for it.
# FOLDER appears whole or not at all; one that this very script has made is left as it is.
set -eu

here=$(CDPATH='' cd -- "$(dirname "$0")" && pwd)
folder=$1

say() { printf 'guest: %s\n' "$*" >&2; }
fail() { say "$*"; exit 1; }

if ! command -v qemu-system-x86_64 >/dev/null 2>&1; then
  say "SKIPPED: qemu-system-x86_64 is not installed, so no kernel of GPIO and cameras was tried. Debian: qemu-system-x86"
  exit 77
fi
for tool in apt-get dpkg-deb make gcc cpio xz; do
  command -v $tool >/dev/null 2>&1 || fail "$tool is missing (packages.txt names all that is needed)"
done
[ -x /bin/busybox ] || fail "/bin/busybox is missing (Debian: busybox-static)"

made_by=$(cat "$here/set_up.sh" "$here/init.sh" | sha256sum | cut -d' ' -f1)
if [ -f "$folder/made_by" ] && [ "$(cat "$folder/made_by")" = "$made_by" ]; then
  say "$(cat "$folder/kernel") is ready in $folder"
  exit 0
fi

work=$folder.partial
rm -rf "$work"
mkdir -p "$work/debs" "$work/kernel" "$work/gpio-sim" "$work/v4l2loopback" "$work/root" "$work/done"
work=$(CDPATH='' cd -- "$work" && pwd)
trap 'rm -rf "$work"' EXIT

# The package lists of this computer or, where they are missing or too old, private ones: nothing is installed.
apt_options=
candidate() { apt-cache $apt_options policy "$1" | sed -n 's/^ *Candidate: //p'; }
download() {
  image=$(apt-cache $apt_options depends linux-image-amd64 2>/dev/null |
    sed -n 's/.*Depends: \(linux-image-[0-9].*-amd64\)$/\1/p' | head -n 1)
  [ -n "$image" ] || return 1
  release=${image#linux-image-}
  series=$(echo "$release" | cut -d. -f1,2)
  version=$(candidate "$image")
  # A security update reaches the signed image last: its headers ask for no older kbuild than theirs, and take a newer one. The
  # source has to be the image's own where the archive still has it.
  source=linux-source-$series
  apt-cache $apt_options madison "$source" | grep -qF " $version " && source=$source=$version
  (cd "$work/debs" && apt-get $apt_options download "$image=$version" "linux-headers-$release=$version" \
    "linux-headers-${release%-amd64}-common=$version" "linux-kbuild-$series" "$source" v4l2loopback-dkms) >>"$work/log" 2>&1
}
if ! download; then
  say "fetching package lists"
  mkdir -p "$work/apt/lists/partial" "$work/apt/archives/partial"
  apt_options="-o Dir::State::lists=$work/apt/lists -o Dir::Cache=$work/apt"
  rm -f "$work/debs"/*
  apt-get $apt_options update >>"$work/log" 2>&1 && download ||
    { cat "$work/log" >&2; fail "Debian's kernel packages cannot be fetched"; }
fi

say "building modules for Debian's kernel $release"
members() { # members PACKAGE FOLDER PATTERN...: unpacks these only; a whole kernel is half a gigabyte
  package=$1 into=$2
  shift 2
  dpkg-deb --fsys-tarfile "$work/debs/$package"_*.deb | tar -x -C "$into" --wildcards "$@"
}
lib=./lib/modules/$release
members "$image" "$work/kernel" "./boot/vmlinuz-$release" "$lib/modules.*" "$lib/kernel/fs/*" "$lib/kernel/net/9p/*" \
  "$lib/kernel/drivers/virtio/*" "$lib/kernel/drivers/media/*" "$lib/kernel/drivers/video/*" "$lib/kernel/lib/*"
for package in "linux-headers-$release" "linux-headers-${release%-amd64}-common" "linux-kbuild-$series" v4l2loopback-dkms; do
  dpkg -x "$work/debs/$package"_*.deb "$work/kernel"
done
headers=$work/kernel/usr/src
sed -i "s#/usr/src/#$headers/#" "$headers/linux-headers-$release/Makefile"  # It includes by an absolute path.

# The tar breaks off when it has its three files.
members "linux-source-$series" "$work" -O "./usr/src/linux-source-$series.tar.xz" 2>/dev/null | xz -dcq 2>/dev/null |
  tar -x -C "$work/gpio-sim" --transform 's#.*/##' --occurrence=1 "linux-source-$series/drivers/gpio/gpio-sim.c" \
    "linux-source-$series/drivers/gpio/gpiolib.h" "linux-source-$series/kernel/irq/irq_sim.c"
# Debian's kernel lacks CONFIG_IRQ_SIM as well, so it becomes a module too: irq_to_desc() is not exported,
# generic_handle_irq() is and does the same here.
sed -i -e 's/handle_simple_irq(irq_to_desc(irqnum));/generic_handle_irq(irqnum);/' \
  -e '/#include <linux\/slab.h>/a #include <linux/module.h>' -e '$a MODULE_LICENSE("GPL");' "$work/gpio-sim/irq_sim.c"
grep -q generic_handle_irq "$work/gpio-sim/irq_sim.c" || fail "irq_sim.c of $version is not as it was: see set_up.sh"
echo 'obj-m := gpio-sim.o irq_sim.o' >"$work/gpio-sim/Kbuild"
cp "$headers"/v4l2loopback-*/*.[ch] "$work/v4l2loopback"
echo 'obj-m := v4l2loopback.o' >"$work/v4l2loopback/Kbuild"
for module in gpio-sim v4l2loopback; do
  make -s -C "$headers/linux-headers-$release" M="$work/$module" modules >"$work/log" 2>&1 ||
    { cat "$work/log" >&2; fail "$module cannot be built for $release"; }
done

# Of the modules only those that init.sh loads, with what they need.
modules=$work/kernel/lib/modules/$release
mkdir "$modules/extra"
cp "$work"/gpio-sim/*.ko "$work"/v4l2loopback/*.ko "$modules/extra"
busybox depmod -b "$work/kernel" "$release"
root=$work/root
mkdir -p "$root/bin" "$root/proc" "$root/sys" "$root/dev" "$root/newroot" "$root/lower" "$root/rw" "$root/lib/modules/$release"
cp /bin/busybox "$root/bin"
for module in virtio_pci 9p 9pnet_virtio overlay configfs gpio-sim v4l2loopback vivid; do
  needs=$(grep -E "^[^:]*/$module\.ko:" "$modules/modules.dep") || fail "$release has no module $module"
  for file in $(echo "$needs" | tr -d :); do
    mkdir -p "$root/lib/modules/$release/${file%/*}"
    strip --strip-debug -o "$root/lib/modules/$release/$file" "$modules/$file"
  done
done
busybox depmod -b "$root" "$release"
cp "$here/init.sh" "$root/init"
chmod +x "$root/init"
(cd "$root" && find . | cpio -o -H newc --quiet) >"$work/done/initramfs.cpio"
cp "$work/kernel/boot/vmlinuz-$release" "$work/done/vmlinuz"
echo "Debian's kernel $release ($version)" >"$work/done/kernel"
echo "$made_by" >"$work/done/made_by"
rm -rf "$folder"
mv "$work/done" "$folder"
say "$(cat "$folder/kernel") is ready in $folder"
