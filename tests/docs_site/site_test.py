#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""site_test.py SOURCE: the site of the documents has the same bytes each time, its links lead somewhere, it loads nothing from elsewhere, and its
search finds what people look for."""
import filecmp
import html
import json
import os
import re
import subprocess
import sys
import tempfile

source = os.path.abspath(sys.argv[1])
faults = []


def built(folder):
    subprocess.run([sys.executable, "-B", os.path.join(source, "docs/site/build_site.py"), source, folder], check=True, stdout=subprocess.DEVNULL)
    return sorted(os.path.relpath(os.path.join(f, n), folder) for f, _, names in os.walk(folder) for n in names)


def anchors(path, cache={}):
    if path not in cache:
        with open(path, encoding="utf-8") as file:
            cache[path] = {html.unescape(a) for a in re.findall(r'\sid="([^"]*)"', file.read())}
    return cache[path]


def check_links(folder, names):
    count = 0
    for name in names:
        if not name.endswith(".html"):
            continue
        with open(os.path.join(folder, name), encoding="utf-8") as file:
            text = file.read()
        for attribute, target in re.findall(r'(href|src)="([^"]*)"', text):
            target = html.unescape(target)
            if re.match(r"(https?|mailto):", target):
                if attribute == "src":
                    faults.append(f"{name}: loads {target}")
                continue
            path, _, fragment = target.partition("#")
            file = os.path.normpath(os.path.join(folder, os.path.dirname(name), path)) if path else os.path.join(folder, name)
            count += 1
            if not os.path.isfile(file):
                faults.append(f"{name}: {target} leads nowhere")
            elif fragment and fragment not in anchors(file):
                faults.append(f"{name}: {target} has no such heading")
        if "<script>" in text or re.search(r"\son[a-z]+=", re.sub(r"<pre>.*?</pre>|<code>.*?</code>", "", text, flags=re.DOTALL)):
            faults.append(f"{name}: has a script of its own")
    if count < 1000:
        faults.append(f"only {count} links")


def check_search(folder):
    """What is asked, and the page among the first three answers."""
    asked = {"stillness_x": "docs/reference/checks.html#stillness_x", "NOT PROVEN": "", "gate late": "", "speed_mm_s": "docs/reference/scenario",
             "calibrate a scan head": "docs/how-to/calibrate-a-head.html", "apt install": "docs/how-to/install.html"}
    script = """
      const fs = require("fs"); const { search } = require(process.argv[1]);
      eval(fs.readFileSync(process.argv[2], "utf8"));
      console.log(JSON.stringify(JSON.parse(process.argv[3]).map((q) => search(globalThis.kerfbenchPages, q).slice(0, 3).map((s) => s[0]))));"""
    done = subprocess.run(["node", "-e", script, os.path.join(folder, "search.js"), os.path.join(folder, "search_index.js"), json.dumps(list(asked))],
                          capture_output=True, text=True, check=True)
    for (question, wanted), found in zip(asked.items(), json.loads(done.stdout)):
        if not any(address.startswith(wanted) for address in found):
            faults.append(f"search for {question!r} finds {found}")
    nothing = subprocess.run(["node", "-e", script, os.path.join(folder, "search.js"), os.path.join(folder, "search_index.js"), '["xyzzy", " "]'],
                             capture_output=True, text=True, check=True)
    if json.loads(nothing.stdout) != [[], []]:
        faults.append("a search for what is not there finds something")


with tempfile.TemporaryDirectory() as work:
    once, twice = os.path.join(work, "once"), os.path.join(work, "twice")
    names = built(once)
    if names != built(twice):
        faults.append("other files the second time")
    same, other, missing = filecmp.cmpfiles(once, twice, names, shallow=False)
    faults += [f"{name}: other bytes the second time" for name in other + missing]
    check_links(once, names)
    check_search(once)
for fault in faults[:40]:
    print(fault)
print(f"{len(names)} files, {len(faults)} faults")
sys.exit(1 if faults else 0)
