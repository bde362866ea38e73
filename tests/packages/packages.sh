#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# packages.sh SOURCE BUILD: makes the packages twice, which gives the same bytes; lintian finds nothing that is not explained; in a bare Debian they
# are installed by apt, run a release to its verdict, and leave nothing behind.
set -eu
source=$1 build=$2
skip() { printf 'packages: skipped: %s\n' "$*"; exit 77; }
fail() { printf 'packages: %s\n' "$*"; exit 1; }
for program in dpkg-shlibdeps lintian debootstrap; do
  command -v "$program" >/dev/null 2>&1 || skip "$program is not installed (packages.txt, part test)"
done
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

"$source/packaging/make_packages.sh" "$build" "$work/once"
# At another time, with another mask of rights and another order of the names.
(umask 077; LC_ALL=C.UTF-8 TZ=Asia/Tokyo "$source/packaging/make_packages.sh" "$build" "$work/twice")
for package in "$work"/once/*.deb; do
  cmp "$package" "$work/twice/$(basename "$package")" || fail "$(basename "$package") has other bytes the second time"
done

lintian --fail-on error,warning,info,pedantic,experimental --tag-display-limit 0 -iIE --pedantic --allow-root "$work"/once/*.deb ||
  fail 'lintian finds what no override explains'

[ "$(id -u)" -eq 0 ] || skip 'a bare root needs root'
root=${KERFBENCH_BARE_ROOT:-$work/root}
code=0
"$source/packaging/bare_root.sh" "$root" "$work"/once/kerfbench_*.deb -- sh -ec '
  kerfbench run /usr/share/kerfbench/scenarios/label-on-belt.yaml
  ls results/label-on-belt/latest/report.html
  # What a CI runs there.
  KERFBENCH_PLAN=/usr/share/kerfbench/scenarios/native/button.yaml KERFBENCH_RESULTS=ci /usr/share/kerfbench/ci/run_plan.sh
  grep "| ✅ | button | PASS |" ci/summary.md
  cd /usr/share/kerfbench
  kerfbench run -q scenarios/native/button.yaml
  ls "$HOME/.local/state/kerfbench/results/"*' >"$work/log" 2>&1 || code=$?
cat "$work/log"
[ "$code" -ne 70 ] || skip 'the bare root could not be made'
[ "$code" -eq 0 ] || fail "in the bare root: exit code $code"
grep -q '^label-on-belt: PASS$' "$work/log" || fail 'no PASS in the bare root'
