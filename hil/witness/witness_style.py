# SPDX-License-Identifier: Apache-2.0
"""CSS as drawings have it: selectors by element, class and id in one step. Others are named as not followed."""
import re

SIMPLE = re.compile(r"(\*|[\w-]+)?((?:[.#][\w-]+)*)")


def declarations(text):
    """Name, value and whether it is !important."""
    for one in text.split(";"):
        name, colon, value = one.partition(":")
        if colon:
            value, mark, _ = value.partition("!")
            yield name.strip().lower(), value.strip(), bool(mark)


class StyleSheet:
    def __init__(self):
        self.rules, self.unread = [], set()

    def add(self, css):
        css = re.sub(r"/\*.*?\*/|<!--|-->", " ", css, flags=re.DOTALL)
        for selectors, body in re.findall(r"([^{}]+)\{([^{}]*)\}", css):
            for selector in selectors.split(","):
                selector = selector.strip()
                found = SIMPLE.fullmatch(selector)
                if not found or not selector:
                    self.unread.add(selector)
                    continue
                marks = re.findall(r"([.#])([\w-]+)", found[2])
                ids = {n for m, n in marks if m == "#"}
                classes = {n for m, n in marks if m == "."}
                kind = found[1] if found[1] != "*" else None
                weight = (len(ids), len(classes), 1 if kind else 0, len(self.rules))
                self.rules.append((weight, kind, ids, classes, list(declarations(body))))

    def of(self, element, kind):
        """Properties of an element: attributes, then rules by weight, then its own style; !important above all."""
        result = {n: v.strip() for n, v in element.attrib.items() if not n.startswith("{") and n != "style"}
        own = {element.get("id")}
        classes = set((element.get("class") or "").split())
        fitting = sorted((r for r in self.rules if r[1] in (None, kind) and r[2] <= own and r[3] <= classes),
                         key=lambda r: r[0])
        steps = [d for rule in fitting for d in rule[4]] + list(declarations(element.get("style") or ""))
        for wanted in (False, True):
            result.update((name, value) for name, value, important in steps if important == wanted)
        return result
