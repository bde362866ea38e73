#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# run_plan.sh: what a CI job does with an installed kerfbench. By variables, so that each CI gives them in its own way:
#   KERFBENCH_PLAN       plan of a release test (kerfbench suite), or a scenario, or several of them
#   KERFBENCH_IMAGE      release image in place of those that are named there; may be empty
#   KERFBENCH_RESULTS    folder for the results; kerfbench-results unless given
# Writes KERFBENCH_RESULTS/junit.xml (all runs) and KERFBENCH_RESULTS/summary.md besides. Exit code: the verdict's, as of kerfbench.
set -u
results=${KERFBENCH_RESULTS:-kerfbench-results}
image=${KERFBENCH_IMAGE:-}
here=$(CDPATH='' cd -- "$(dirname "$0")" && pwd)
: "${KERFBENCH_PLAN:?a plan or scenarios}"
mkdir -p "$results" || exit 2

# A plan has runs, a scenario has a drawing or something that it extends.
first=${KERFBENCH_PLAN%% *}
[ -f "$first" ] || { echo "$first: no such file" >&2; exit 65; }
command=run
if grep -q '^runs:' "$first"; then command=suite; fi
set -f
# Several names stand in one variable, parted by blanks.
# shellcheck disable=SC2086
set -- $KERFBENCH_PLAN
set +f
[ -z "$image" ] || set -- "$@" --image "$image"
code=0
kerfbench "$command" "$@" --results-dir "$results" || code=$?
python3 "$here/summary.py" "$results" --exit-code "$code" || [ "$code" -ne 0 ] || code=2
exit "$code"
