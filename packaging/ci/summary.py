#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""summary.py RESULTS --exit-code N: brings what is in a folder of results together for a CI's page.

Writes RESULTS/junit.xml with all runs and RESULTS/summary.md, a table with a line for each. What is taken from results is data: it is
escaped for Markdown and for XML. Uses Python's own library alone.
"""
import argparse
import glob
import json
import os
import re
import sys
import xml.etree.ElementTree as xml

MEANING = {0: "PASS", 1: "FAIL", 3: "INVALID: the evidence cannot be trusted", 4: "NOT PROVEN: inside the guard band",
           65: "a bad input file", 64: "a wrong command line", 2: "the bench itself broke"}


def cell(text):
    """Text in a cell of a Markdown table: no markup of its own, no HTML, one line. Nobody is mentioned, no issue and no address is
    linked: GitHub and GitLab look for these behind all escapes, so that an invisible character parts them."""
    text = re.sub(r"[\x00-\x1f\x7f-\x9f\u2028\u2029\u202a-\u202e\u2066-\u2069]+", " ", str(text))[:300]
    text = re.sub(r"[@#!$%~&](?=\w)|(?<=\w)://|www(?=\.)", lambda found: found[0] + "\u200b", text)
    text = text.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")
    return re.sub(r"([\\`*_{}\[\]()#+!|~@])", r"\\\1", text)


def newest(folder, name):
    """The file of that name in the newest dated folder of each scenario or plan below RESULTS."""
    found = {}
    for path in sorted(glob.glob(os.path.join(glob.escape(folder), "*", "2*", name))):
        found[os.path.dirname(os.path.dirname(path))] = path
    return [found[key] for key in sorted(found)]


def rows(folder):
    """(as wanted?, name, verdict, sentence, digest) of each run; of a plan's run its expectation counts."""
    found = []
    for path in newest(folder, "summary.json"):
        with open(path, encoding="utf-8") as file:
            suite = json.load(file)
        for run in suite["runs"]:
            result = run["result"] or {}
            good = run["outcome"] == "as expected"
            word = result.get("verdict", run["outcome"])
            if good and word != "PASS":
                word += " as expected"
            found.append((good, run["name"], word, run["why"] or result.get("summary", ""), result.get("digest", "")))
    for path in newest(folder, "verdict.json"):
        with open(path, encoding="utf-8") as file:
            verdict = json.load(file)
        found.append((verdict["verdict"] == "PASS", verdict["scenario"], verdict["verdict"], verdict["summary"], verdict["digest"]))
    return found


def write_summary(folder, runs, code):
    lines = ["## Kerfbench", "", f"**{cell(MEANING.get(code, f'exit code {code}'))}**", "",
             "| | run | verdict | what | digest |", "|---|---|---|---|---|"]
    for good, name, verdict, sentence, digest in runs:
        lines.append(f"| {'✅' if good else '❌'} | {cell(name)} | {cell(verdict)} | {cell(sentence)} | {cell(digest[:12])} |")
    if not runs:
        lines.append("| ❌ | | no run has results | the log says why | |")
    lines += ["", "Each run's whole report is in the artifact: `report.html`, one page that needs nothing else.", ""]
    with open(os.path.join(folder, "summary.md"), "w", encoding="utf-8") as file:
        file.write("\n".join(lines))


def write_junit(folder):
    """All suites in one file."""
    root = xml.Element("testsuites", name="kerfbench")
    for path in newest(folder, "junit.xml"):
        tree = xml.parse(path).getroot()
        root.extend([tree] if tree.tag == "testsuite" else list(tree))
    xml.ElementTree(root).write(os.path.join(folder, "junit.xml"), encoding="utf-8", xml_declaration=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("results")
    parser.add_argument("--exit-code", type=int, default=0)
    arguments = parser.parse_args()
    runs = rows(arguments.results)
    write_summary(arguments.results, runs, arguments.exit_code)
    write_junit(arguments.results)
    return 0 if runs or arguments.exit_code else 1


if __name__ == "__main__":
    sys.exit(main())
