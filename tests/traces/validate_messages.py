# SPDX-License-Identifier: Apache-2.0
"""validate_messages.py FOLDER: each line of FOLDER/N.jsonl against the JSON Schema in FOLDER/N.json."""

import json
import pathlib
import sys

import jsonschema

folder = pathlib.Path(sys.argv[1])
messages = 0
for schema_file in sorted(folder.glob("*.json")):
    schema = json.loads(schema_file.read_text())
    jsonschema.Draft202012Validator.check_schema(schema)
    validator = jsonschema.Draft202012Validator(schema)
    for number, line in enumerate(schema_file.with_suffix(".jsonl").read_text().splitlines(), 1):
        for error in validator.iter_errors(json.loads(line)):
            sys.exit(f"{schema_file.stem}, message {number}: {error.json_path}: {error.message}")
        messages += 1
print(f"{messages} messages")
