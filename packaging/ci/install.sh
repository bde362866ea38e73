#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# install.sh DEB-OR-URL...: installs the packages of a bench, as root or by sudo; names and addresses of .deb files. python3 is what summary.py needs.
set -eu
as_root=
if [ "$(id -u)" -ne 0 ]; then as_root=sudo; fi
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
chmod 755 "$folder"
$as_root apt-get update -q
for deb in "$@"; do
  case $deb in
    http://* | https://*)
      command -v curl >/dev/null 2>&1 || $as_root env DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends curl ca-certificates
      # An address may not lead to another kind of it.
      curl --fail --silent --show-error --location --proto '=https,http' --output "$folder/$(basename "$deb")" "$deb"
      ;;
    *) cp "$deb" "$folder/" ;;
  esac
done
$as_root env DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends python3 "$folder"/*.deb
kerfbench --version
