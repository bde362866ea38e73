# SPDX-License-Identifier: Apache-2.0
"""The other side: what a browser, a parser of XML or JSON, a terminal, a shell, a spreadsheet, a page of Markdown or a CI server
takes an output for. Each function returns what is wrong; empty: nothing."""
import csv
import html.parser
import io
import json
import re
import subprocess
import sys
import xml.etree.ElementTree

CONTROL = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f]")
WORKFLOW = re.compile(r"^\s*::|##\[|##vso\[|##teamcity\[", re.MULTILINE)


def utf8(content):
    try:
        return content.decode("utf-8"), []
    except UnicodeDecodeError as error:
        return content.decode("utf-8", "replace"), [f"is no UTF-8: {error}"]


class _Page(html.parser.HTMLParser):
    def __init__(self):
        super().__init__(convert_charrefs=True)
        self.wrong, self.inside, self.texts = [], [], []

    def handle_starttag(self, tag, attrs):
        if tag in ("kb", "kbtag"):
            self.wrong.append(f"an element <{tag}>")
        for name, value in attrs:
            if name.startswith("onkb") or name == "kb":
                self.wrong.append(f"an attribute {name} of <{tag}>")
            if name in ("href", "src") and (value or "").strip().lower().startswith("javascript:"):
                self.wrong.append(f"a script in {name} of <{tag}>")
        self.inside.append(tag)

    def handle_endtag(self, tag):
        if tag in self.inside:
            while self.inside.pop() != tag:
                pass

    def handle_data(self, data):
        if self.inside and self.inside[-1] == "script" and re.search(r"(?<![\"'\w])kb\(\)", data):
            self.wrong.append("kb() in a script")
        self.texts.append(data)


def page(content):
    text, wrong = utf8(content)
    parsed = _Page()
    parsed.feed(text)
    if found := CONTROL.search(text.replace("\r", "")):
        wrong.append(f"control character U+{ord(found[0]):04X}")
    return wrong + parsed.wrong


def markup(content):
    """XML, SVG among it."""
    try:
        root = xml.etree.ElementTree.fromstring(content)
    except xml.etree.ElementTree.ParseError as error:
        return [f"is not well-formed: {error}"]
    return [f"an element {node.tag}" for node in root.iter() if "kb" in str(node.tag)] + [
        f"an attribute {name}" for node in root.iter() for name in node.attrib if "kb" in name and name != "kerfbench"]


def values(content, lines=False):
    """JSON, or a value of JSON on each line."""
    text, wrong = utf8(content)

    def no_key(pairs):
        if any(key == "kb" for key, _ in pairs):
            wrong.append("a key kb")
        if len({key for key, _ in pairs}) != len(pairs):
            wrong.append("a key twice")
        return dict(pairs)
    for part in text.splitlines() if lines else [text]:
        try:
            json.loads(part, object_pairs_hook=no_key)
        except ValueError as error:
            wrong.append(f"is no JSON: {error}")
    return wrong


def terminal(content):
    text, wrong = utf8(content)
    if found := CONTROL.search(text):
        wrong.append(f"control character U+{ord(found[0]):04X}")
    if found := WORKFLOW.search(text):
        wrong.append(f"a CI server obeys {found[0].strip()!r}")
    if re.search(r"^PASS kb", text, re.MULTILINE):
        wrong.append("a line that looks like a verdict")
    return wrong


def markdown(content):
    text, wrong = utf8(content)
    rows = [line for line in text.splitlines() if line.startswith("|")]
    columns = {len(re.findall(r"(?<!\\)\|", row)) for row in rows}
    if len(columns) != 1:
        wrong.append(f"rows of {sorted(columns)} bars")
    for pattern, what in ((r"<kbtag|<script", "HTML"), (r"(?<!\\)\]\(", "a link"), (r"@kbuser", "somebody is mentioned"),
                          (r"\w://kb", "an address"), (r"(?<!\\)`", "code")):
        if re.search(pattern, re.sub(r"`report\.html`", "", text)):
            wrong.append(what)
    return wrong


def table(content):
    """A spreadsheet takes a cell that begins so for a formula, unless it is a number."""
    text, wrong = utf8(content)
    for row in csv.reader(io.StringIO(text)):
        for cell in row:
            if cell[:1] in "=+-@\t\r" and cell:
                try:
                    float(cell)
                except ValueError:
                    wrong.append(f"a formula: {cell[:30]!r}")
    return wrong


def gcode(content):
    text, wrong = utf8(content)
    if re.search(r"999", re.sub(r"\([^)]*\)", "", text)):
        wrong.append("a move that was written in a name")
    return wrong


def source(content):
    """C: what is left when comments and texts are taken out."""
    text, wrong = utf8(content)
    bare = re.sub(r'/\*.*?\*/|//[^\n]*|"(?:\\.|[^"\\\n])*"', " ", text, flags=re.DOTALL)
    return wrong + (["code that was written in a name"] if re.search(r"\bint kb\b", bare) else [])


def shell(command, words, folder):
    """Pastes a command into a shell in which `./bench` and `kerfbench` say what they were given."""
    say = f"#!{sys.executable}\nimport json, os, sys\nprint(json.dumps([os.fsencode(word).hex() for word in sys.argv[1:]]))\n"
    for name in ("bench", "kerfbench"):
        (folder / name).write_text(say)
        (folder / name).chmod(0o755)
    done = subprocess.run(["sh", "-c", command], cwd=folder, capture_output=True, check=False,
                          env={"PATH": f"{folder}:/usr/bin:/bin", "LANG": "C.UTF-8"})
    wrong = ["KBMARK was made"] if (folder / "KBMARK").exists() else []
    try:
        got = [bytes.fromhex(word) for word in json.loads(done.stdout)]
    except ValueError:
        return wrong + [f"runs no command: {done.stderr.decode(errors='replace')[:100]}"]
    return wrong + ([] if got == words else [f"another command: {got}"])
