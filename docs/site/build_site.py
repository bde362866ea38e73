#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""build_site.py SOURCE OUT: the project's pages as a site that is read from a folder, without a server and without a network.

Each .md becomes an .html in the same place, by cmark-gfm; links between pages follow. Pictures are copied. A link to a source, which is no
page, stays as its name. search.js has what the search needs; nothing is loaded from elsewhere. The same sources give the same bytes.
"""
import html
import json
import os
import re
import shutil
import subprocess
import sys

# In the order of the menu: title, pages. What is not named here is under "More".
PARTS = [
    ("Start", ["README.md", "docs/tutorial/first-run.md", "docs/how-to/install.md"]),
    ("How to", "docs/how-to"),
    ("Reference", "docs/reference"),
    ("Explanation", "docs/explanation"),
    ("Decisions", "docs/explanation/decisions"),
]
PICTURES = (".png", ".svg", ".jpg")


def pages_of(source):
    listed = subprocess.run(["git", "-C", source, "ls-files", "--cached", "--others", "--exclude-standard", "*.md"], capture_output=True, text=True)
    if listed.returncode == 0 and listed.stdout:
        return sorted(p for p in set(listed.stdout.split("\n")) if p and os.path.isfile(os.path.join(source, p)))
    found = []
    for folder, folders, files in os.walk(source):
        folders[:] = sorted(f for f in folders if not f.startswith(".") and f not in ("build", "results", "node_modules"))
        found += [os.path.relpath(os.path.join(folder, f), source) for f in files if f.endswith(".md")]
    return sorted(found)


def converted(text):
    """HTML of a page. Raw HTML in it is left out by cmark-gfm, and links with strange schemes too."""
    done = subprocess.run(["cmark-gfm", "-e", "table", "-e", "strikethrough", "-e", "autolink"], input=text.encode(),
                          capture_output=True, check=True)
    return done.stdout.decode()


def plain(fragment):
    return html.unescape(re.sub(r"<[^>]+>", " ", fragment))


def anchor(heading):
    """As forges make it: lower case, without punctuation, hyphens for blanks."""
    kept = (c for c in heading.lower() if c.isalnum() or c in " -_")
    return "".join("-" if c == " " else c for c in kept)


def with_anchors(body):
    """Headings get anchors; returns the body and the headings [(level, anchor, text)]."""
    seen, headings = {}, []

    def mark(match):
        level, inner = match.group(1), match.group(2)
        text = re.sub(r"\s+", " ", plain(re.sub(r"</?code>", "", inner)).strip())
        name = anchor(html.unescape(re.sub(r"<[^>]+>", "", inner)).strip())
        count = seen[name] = seen.get(name, -1) + 1
        name = f"{name}-{count}" if count else name
        headings.append((int(level), name, text))
        return f'<h{level} id="{html.escape(name, quote=True)}">{inner}</h{level}>'

    return re.sub(r"<h([1-6])>(.*?)</h\1>", mark, body, flags=re.DOTALL), headings


def with_links(body, page, known, needed):
    """Links to pages lead to their HTML; pictures are needed; other files of the project are named and not linked."""
    folder = os.path.dirname(page)

    def follow(match):
        tag, before, attribute, target, after = match.groups()
        target = html.unescape(target)
        if re.match(r"[a-z][a-z0-9+.-]*:|#", target):
            return match.group(0)
        path, _, fragment = target.partition("#")
        to = os.path.normpath(os.path.join(folder, path))
        if to in known:
            path = path[:-3] + ".html"
        elif to.endswith(PICTURES):
            needed.add(to)
        else:
            return f'<{tag}{before} title="{html.escape(to, quote=True)} in the sources"{after}>'
        return f'<{tag}{before} {attribute}="{html.escape(path + ("#" + fragment if fragment else ""), quote=True)}"{after}>'

    return re.sub(r'<(a|img)((?:\s[^>]*?)?) (href|src)="([^"]*)"([^>]*)>', follow, body)


def menu_of(titles):
    """[(part, [page])]; each page once."""
    left = set(titles)
    menu = []
    for name, chosen in PARTS:
        pages = [p for p in chosen if p in left] if isinstance(chosen, list) else sorted(
            p for p in left if os.path.dirname(p) == chosen)
        left -= set(pages)
        menu.append((name, pages))
    return menu + [("More", sorted(left))]


def menu_html(menu, titles, page):
    up = "../" * page.count("/")
    text = ""
    for name, pages in menu:
        if not pages:
            continue
        here = " open" if page in pages else ""
        text += f"<details{here}><summary>{name}</summary><ul>"
        for each in pages:
            current = ' aria-current="page"' if each == page else ""
            text += f'<li><a href="{html.escape(up + each[:-3])}.html"{current}>{html.escape(titles[each])}</a></li>'
        text += "</ul></details>"
    return text


def contents_html(headings):
    items = [f'<li class="level{level}"><a href="#{html.escape(name, quote=True)}">{html.escape(text)}</a></li>'
             for level, name, text in headings if level in (2, 3)]
    return f'<nav class="contents" aria-label="On this page"><ul>{"".join(items)}</ul></nav>' if len(items) > 2 else ""


def page_html(frame, page, title, menu, body, headings):
    up = "../" * page.count("/")
    values = {"UP": up, "TITLE": html.escape(title), "MENU": menu, "BODY": body, "CONTENTS": contents_html(headings)}
    return re.sub(r"@([A-Z]+)@", lambda m: values[m.group(1)], frame)


def search_entries(page, title, body):
    """One for each section: [address, page's title, heading, words]."""
    entries = []
    pieces = re.split(r'<h[1-6] id="([^"]*)">(.*?)</h[1-6]>', body, flags=re.DOTALL)
    address = page[:-3] + ".html"
    entries.append([address, title, title, re.sub(r"\s+", " ", plain(pieces[0])).strip()])
    for name, heading, text in zip(pieces[1::3], pieces[2::3], pieces[3::3]):
        entries.append([f"{address}#{html.unescape(name)}", title, re.sub(r"\s+", " ", plain(heading)).strip(),
                        re.sub(r"\s+", " ", plain(text)).strip()])
    return entries


def main():
    source, out = (os.path.abspath(p) for p in sys.argv[1:3])
    here = os.path.dirname(os.path.abspath(__file__))
    with open(os.path.join(here, "page.html"), encoding="utf-8") as file:
        frame = file.read().split("-->\n", 1)[1]
    known = set(pages_of(source))
    bodies, titles, all_headings, needed = {}, {}, {}, set()
    for page in sorted(known):
        with open(os.path.join(source, page), encoding="utf-8") as file:
            body, headings = with_anchors(converted(file.read()))
        titles[page] = next((text for level, _, text in headings if level == 1), page)
        bodies[page] = with_links(body, page, known, needed)
        all_headings[page] = headings
    menu, entries = menu_of(titles), []
    shutil.rmtree(out, ignore_errors=True)
    for page in sorted(known):
        target = os.path.join(out, page[:-3] + ".html")
        os.makedirs(os.path.dirname(target), exist_ok=True)
        with open(target, "w", encoding="utf-8") as file:
            file.write(page_html(frame, page, titles[page], menu_html(menu, titles, page), bodies[page], all_headings[page]))
        entries += search_entries(page, titles[page], bodies[page])
    for picture in sorted(needed):
        os.makedirs(os.path.join(out, os.path.dirname(picture)), exist_ok=True)
        shutil.copyfile(os.path.join(source, picture), os.path.join(out, picture))
    shutil.copyfile(os.path.join(out, "README.html"), os.path.join(out, "index.html"))
    shutil.copyfile(os.path.join(here, "site.css"), os.path.join(out, "site.css"))
    shutil.copyfile(os.path.join(here, "search.js"), os.path.join(out, "search.js"))
    with open(os.path.join(out, "search_index.js"), "w", encoding="utf-8") as file:
        # A script and not JSON: pages that are read from a folder may not fetch files.
        file.write("globalThis.kerfbenchPages = " + json.dumps(entries, ensure_ascii=False, separators=(",", ":")) + ";\n")
    print(f"{len(known)} pages: {os.path.join(out, 'index.html')}")


if __name__ == "__main__":
    main()
