#!/bin/busybox sh
# SPDX-License-Identifier: Apache-2.0
# The guest's first process: mounts the host's files (9p, read-only, what is written stays in memory), loads the
# modules, and runs the job that run.sh left in the folder that the two share.
/bin/busybox --install -s /bin
export PATH=/bin:/sbin:/usr/bin:/usr/sbin
mount -t proc proc /proc
mount -t sysfs sys /sys
mount -t devtmpfs dev /dev

fail() {
  echo "GUEST FAILED: $*"
  poweroff -f
}
for module in virtio_pci 9pnet_virtio 9p overlay configfs gpio-sim; do
  modprobe $module || fail "modprobe $module"
done
modprobe v4l2loopback video_nr=20,21 devices=2 exclusive_caps=0 max_buffers=8 || fail 'modprobe v4l2loopback'
modprobe vivid n_devs=1 node_types=0x1 vid_cap_nr=30 num_inputs=2 input_types=0xc ccs_cap_mode=1 || fail 'modprobe vivid'

mount -t 9p -o ro,trans=virtio,version=9p2000.L,msize=512000,cache=loose host /lower || fail 'mount host'
mount -t tmpfs -o size=60% rw /rw
mkdir /rw/upper /rw/work /rw/shared
mount -t overlay -o lowerdir=/lower,upperdir=/rw/upper,workdir=/rw/work over /newroot || fail 'mount overlay'
mount -t 9p -o rw,trans=virtio,version=9p2000.L,msize=512000,cache=none shared /rw/shared || fail 'mount shared'
root=/newroot
mount -t proc proc $root/proc
mount -t sysfs sys $root/sys
mount -t devtmpfs dev $root/dev
mkdir -p $root/dev/pts
mount -t devpts pts $root/dev/pts
mount -t configfs config $root/sys/kernel/config
mount -t tmpfs run $root/run
mkdir $root/run/shared
mount --bind /rw/shared $root/run/shared

# Virtual time runs on while the guest waits for the host's disk, so all that the job will read is read beforehand.
while read -r file; do cat "$root$file"; done <$root/run/shared/files >/dev/null
chroot $root /bin/sh /run/shared/job >$root/run/shared/log 2>&1
echo $? >$root/run/shared/exit_code
sync
poweroff -f
