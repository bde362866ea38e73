#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# install_tree.sh SOURCE BUILD: installs into a folder of its own and uses it as a user does who has neither sources nor build.
set -eu
source=$1 build=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
chmod 755 "$work"
prefix=$work/prefix
share=$prefix/share/kerfbench
export HOME="$work/home" NO_COLOR=1
mkdir "$HOME"
fail() { printf 'install_tree: %s\n' "$*"; exit 1; }
# Runs as somebody who may write nothing of what is installed.
as_nobody() { if [ "$(id -u)" -eq 0 ]; then setpriv --reuid=65534 --regid=65534 --clear-groups "$@"; else "$@"; fi; }

cmake --install "$build" --prefix "$prefix" >"$work/log" || { cat "$work/log"; exit 1; }
cd "$work"
PATH=$prefix/bin:$PATH
[ "$(command -v kerfbench)" = "$prefix/bin/kerfbench" ] || fail 'kerfbench is not installed'

# Nothing that is installed knows where it was built.
if grep -rlF -e "$build" -e "$source/" "$prefix/lib" "$prefix/share/kerfbench" "$prefix/share/man"; then fail 'these name the folder of the build'; fi
[ -z "$(find "$prefix" -type d -empty)" ] || fail "empty folders: $(find "$prefix" -type d -empty)"
[ -z "$(find "$prefix" -xtype l)" ] || fail "links that lead nowhere: $(find "$prefix" -xtype l)"

# Every scenario, machine and drawing finds what it names. Grbl's release is for the user to bring.
find "$share/scenarios" "$share/machines" -name '*.yaml' ! -name '*.camera.yaml' ! -name drivers.yaml ! -name grbl-plate.yaml ! -path '*/safe/*' ! -path '*/pins/*' |
  sort | xargs kerfbench lint -q || fail 'a shipped file is not good'
kerfplan library check >/dev/null || fail 'kerfplan finds no library'
kerfbench gauge --help | grep -qF "$share/machines/two-mirror.yaml" || fail 'gauge does not know the shipped machine'
kerfbench man calibrate head | grep -q '^\.TH KERFBENCH' || fail 'kerfbench-instrument is not found'
for page in kerfbench.1 kerfbench-run.1 kerfbench-calibrate-head.1 kerfplan-gcode.1; do
  gzip -dc "$prefix/share/man/man1/$page.gz" | grep -q '^\.SH SYNOPSIS' || fail "no man page $page"
done

# A whole run by somebody who cannot write where he is: his results go to his own state folder.
mkdir state
chmod 777 state
code=0
(cd "$share" && as_nobody env XDG_STATE_HOME="$work/state" kerfbench run scenarios/native/button.yaml --twin fast --no-pictures >"$work/run" 2>&1) || code=$?
[ "$code" -eq 0 ] || { cat run; fail "the run ends with $code"; }
grep -q '^button[a-z-]*: PASS$' run || { cat run; fail 'no PASS'; }
[ -f "$(find state/kerfbench/results -name verdict.json)" ] || fail 'no results in XDG_STATE_HOME'
# Where one can write, the results are there.
kerfbench run "$share/scenarios/native/button.yaml" --twin fast --no-pictures -q >/dev/null && [ -d results ] || fail 'no results in the folder'

# Without the children under the GPL an AVR image is refused, with the package to install.
mv "$prefix/lib/kerfbench/bin/kerfbench-avr" "$work/"
code=0
kerfbench run "$share/scenarios/label-on-belt.yaml" >run 2>&1 || code=$?
[ "$code" -eq 65 ] && grep -q 'install the package kerfbench-emulators' run || { cat run; fail "exit code $code without the emulator"; }
mv "$work/kerfbench-avr" "$prefix/lib/kerfbench/bin/"

# The example, as somebody builds it who has the package alone.
cp -r "$prefix/share/doc/kerfbench-dev/examples/own-check" own
cmake -S own -B own/build -DCMAKE_PREFIX_PATH="$prefix" -DCMAKE_BUILD_TYPE=Release >log 2>&1 && cmake --build own/build >>log 2>&1 || { cat log; fail 'the example cannot be built'; }
scenario=$share/scenarios/native/button.yaml
own/build/own-check "$scenario" >run || { cat run; fail 'the own check does not PASS'; }
grep -q '^light_at_rest: PASS' run || fail 'the own check says nothing'
code=0
own/build/own-check "$scenario" 8 >run || code=$?
[ "$code" -eq 1 ] && grep -q '^light_at_rest: FAIL, 8\.' run || { cat run; fail 'the own check does not see light at rest'; }
own/build/own-check "$scenario" --pins "$(find results -name pins.vcd | head -n 1)" >run || { cat run; fail 'the own check refuses the pins of a good run'; }

# The steps of the CI templates (packaging/ci), on a plan of one short run.
"$source/tests/packages/ci_steps.sh" "$source" "$share" || fail 'the steps for CI'
echo 'install_tree: good'
