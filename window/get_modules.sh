#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Puts the packages that package-lock.json names, each by its digest, into node_modules. Nothing of them is run.
set -eu
cd "$(dirname "$0")"
if ! command -v npm >/dev/null 2>&1; then
  echo "npm is missing: Debian's package npm, or Node's own, has it" >&2
  exit 1
fi
if ! npm ci --prefer-offline --ignore-scripts --no-audit --no-fund --loglevel=error; then
  echo "The window's packages could not be got. They come from the registry of npm once; from then on nothing is fetched." >&2
  exit 1
fi
# The build takes its date for theirs.
touch node_modules/.package-lock.json
