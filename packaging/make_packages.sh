#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# make_packages.sh BUILD [FOLDER]: the Debian packages of what the target `installable` has built there, in BUILD/packages or FOLDER.
# The same sources give the same bytes: all times are that of packaging/debian/changelog.
set -eu
build=$1
root=$(CDPATH='' cd -- "$(dirname "$0")/.." && pwd)
folder=${2:-$build/packages}
SOURCE_DATE_EPOCH=$(dpkg-parsechangelog -l "$root/packaging/debian/changelog" -S Timestamp)
export SOURCE_DATE_EPOCH
umask 022
rm -rf "$folder"
log=$(mktemp)
trap 'rm -f "$log"' EXIT
(cd "$build" && cpack -G DEB -B "$folder" >"$log" 2>&1) || { cat "$log" >&2; exit 2; }
rm -rf "$folder/_CPack_Packages"
find "$folder" -name '*.deb' | sort
