#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# ci_steps.sh SOURCE SHARE: the steps of action.yml and of the GitLab template, as a runner runs them, with the kerfbench in PATH and the data in
# SHARE. GitHub's own service is a server here, which keeps what it is told.
set -eu
source=$1 share=$2
work=$(mktemp -d)
server=
trap '[ -z "$server" ] || kill "$server" 2>/dev/null; rm -rf "$work"' EXIT
fail() { printf 'ci_steps: %s\n' "$*"; exit 1; }
cd "$work"

# A plan with a good run, and one that asks for more than can be measured, as is expected of it.
sed "s|\.\./|$share/|" >plan.yaml <<'PLAN'
version: 1
name: short
title: Two short runs
defaults: {twin: fast}
runs:
  - scenario: ../scenarios/native/button.yaml
  - name: button-strict
    scenario: ../scenarios/native/button.yaml
    limits: {path_mm: 0.001}
    expect: INVALID
PLAN
python3 -B "$source/tests/packages/action_steps.py" "$source" "$work/steps"

# step NAME: that step of action.yml, in a shell as GitHub starts it.
step() { (export GITHUB_OUTPUT="$work/output" GITHUB_STEP_SUMMARY="$work/page" KERFBENCH_ACTION="$source"; bash --noprofile --norc -eo pipefail "$work/steps/$1.sh"); }
export KERFBENCH_PLAN=plan.yaml KERFBENCH_IMAGE="" KERFBENCH_RESULTS=results CI=true
step Run >log 2>&1 || { cat log; fail 'the step Run breaks'; }
grep -qx 'exit-code=0' output || { cat log output; fail 'the plan is not as expected'; }
grep -q '| ✅ | button | PASS |' page && grep -q '| ✅ | button-strict | INVALID as expected |' page || { cat page; fail 'the summary'; }
python3 -c '
import sys, xml.etree.ElementTree as xml
root = xml.parse("results/junit.xml").getroot()
sys.exit(0 if root.tag == "testsuites" and len(root) > 0 and root.iter("testcase") else 1)' || fail 'junit.xml'
KERFBENCH_EXIT_CODE=0 step Verdict || fail 'a PASS does not pass'

# A bad release: everything is kept, and only then the job fails.
rm -rf output page results
cat >bad.yaml <<SCENARIO
extends: $share/scenarios/native/button.yaml
name: button-bad
checks: {path_mm: 0.001}
SCENARIO
KERFBENCH_PLAN=bad.yaml step Run >log 2>&1 || { cat log; fail 'the step Run of a bad release breaks'; }
code=$(sed -n 's/^exit-code=//p' output)
[ "$code" -ne 0 ] && [ -f results/junit.xml ] && grep -q '| ❌ |' page || { cat log output page; fail 'a bad release'; }
if KERFBENCH_EXIT_CODE=$code step Verdict; then fail 'a bad release passes'; fi

# The comment: made once, then replaced. Text from results has no markup of its own.
python3 -B "$source/tests/packages/github_service.py" "$work/service" &
server=$!
for _ in $(seq 300); do [ -s service/port ] && break; sleep 0.1; done
GITHUB_API_URL="http://127.0.0.1:$(cat service/port)"
export GITHUB_API_URL GITHUB_REPOSITORY=owner/firmware GITHUB_EVENT_PATH=event.json GITHUB_TOKEN=secret
no_proxy=127.0.0.1 NO_PROXY=127.0.0.1
export no_proxy NO_PROXY
echo '{"pull_request": {"number": 7}}' >event.json
step Comment && step Comment || fail 'the step Comment'
[ "$(grep -c '^POST /repos/owner/firmware/issues/7/comments$' service/asked)" = 1 ] || { cat service/asked; fail 'not one comment'; }
[ "$(grep -c '^PATCH /repos/owner/firmware/issues/comments/1$' service/asked)" = 1 ] || { cat service/asked; fail 'the comment is not replaced'; }
echo '{}' >event.json
step Comment | grep -q 'no pull request' || fail 'a comment without a pull request'

# GitLab's script.
rm -rf results
script=$(sed -n 's|^    - /usr/share/kerfbench|'"$share"'|p' "$source/packaging/ci/kerfbench.gitlab-ci.yml")
sh -c "$script" >log 2>&1 || { cat log; fail "GitLab's script"; }
[ -f results/junit.xml ] || fail "GitLab's report"
# What is broken is no PASS.
code=0
KERFBENCH_PLAN=missing.yaml sh -c "$script" >log 2>&1 || code=$?
[ "$code" -eq 65 ] || fail "a missing plan ends with $code"
echo 'ci_steps: good'
