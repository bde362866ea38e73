#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Holds verdict.json files against their schema: validate.py SCHEMA FOLDER.

Every file of the folder is one verdict that a test's run wrote. Lists everything that is wrong. Exit code 0 if all are as
docs/reference/results.md says, else 1.
"""
import json
import pathlib
import sys

import jsonschema


def main():
    schema = json.loads(pathlib.Path(sys.argv[1]).read_text(encoding="utf-8"))
    jsonschema.Draft202012Validator.check_schema(schema)
    validator = jsonschema.Draft202012Validator(schema)
    files = sorted(pathlib.Path(sys.argv[2]).glob("*.json"))
    wrong = 0
    for file in files:
        verdict = json.loads(file.read_text(encoding="utf-8"))
        for error in validator.iter_errors(verdict):
            wrong += 1
            print(f"{file.name} ({verdict.get('scenario')}): {error.json_path}: {error.message}")
    # The schema itself must be able to refuse: one field more, one field less.
    if files:
        verdict = json.loads(files[0].read_text(encoding="utf-8"))
        for spoilt in ({**verdict, "unknown": 1}, {k: v for k, v in verdict.items() if k != "digest"}):
            if validator.is_valid(spoilt):
                wrong += 1
                print("the schema takes a verdict that it must refuse")
    print(f"{len(files)} verdicts, {wrong} faults")
    return 1 if wrong else 0


sys.exit(main())
