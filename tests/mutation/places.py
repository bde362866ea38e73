# SPDX-License-Identifier: Apache-2.0
"""Finds the places of a C++ source where a rule, not a person, puts a fault: comparisons, signs, constants, connectives.

Clang's parser tells the less-than sign of a comparison from the bracket of a template, a minus from the arrow of a
pointer, and a number from the same digits in a string. The rule:

- A comparison becomes its neighbour at the limit (< and <=, > and >=, == and !=) or looks the other way (< and >).
- A sign turns: + and -, += and -=; the minus in front of a value is left out. Concatenation of text has no sign.
- A constant with a fraction grows by a quarter, and 0.0 becomes 1.0; a whole one grows by one; true and false swap.
- && and || swap.

Left alone are: what stands in `throw` and `static_assert`; template arguments; a whole number that is all of an index,
or all of an argument of a member of Eigen or OpenCV, for it says which element or how many, and a build without
assertions would read beyond the end; ++ and --, which are neither sign nor constant.
"""
import collections
import decimal
import glob
import os
import re
import sys

try:
    from clang import cindex
except ModuleNotFoundError:  # Debian keeps it where only its own interpreter looks.
    sys.path.append("/usr/lib/python3/dist-packages")
    from clang import cindex

Kind = cindex.CursorKind
Place = collections.namedtuple("Place", "file offset text puts line inside name_of")

COMPARISONS = {"<": ("<=", ">"), "<=": ("<", ">="), ">": (">=", "<"), ">=": (">", "<="), "==": ("!=",), "!=": ("==",)}
SIGNS = {"+": ("-",), "-": ("+",), "+=": ("-=",), "-=": ("+=",)}
CONNECTIVES = {"&&": ("||",), "||": ("&&",)}
SWAPPED = {"true": ("false",), "false": ("true",)}
OPERATORS = COMPARISONS | SIGNS | CONNECTIVES
WORDS = {"<": "less", "<=": "at-most", ">": "more", ">=": "at-least", "==": "equal", "!=": "unequal", "+": "plus",
         "-": "minus", "+=": "add", "-=": "take", "&&": "and", "||": "or", "": "no-sign"}
OPERATOR_CURSORS = {Kind.BINARY_OPERATOR, Kind.COMPOUND_ASSIGNMENT_OPERATOR, Kind.UNARY_OPERATOR}
NAMED = {Kind.FUNCTION_DECL, Kind.CXX_METHOD, Kind.CONSTRUCTOR, Kind.DESTRUCTOR, Kind.CONVERSION_FUNCTION,
         Kind.FUNCTION_TEMPLATE, Kind.STRUCT_DECL, Kind.CLASS_DECL, Kind.CLASS_TEMPLATE}
EXCLUDED = {Kind.CXX_THROW_EXPR, Kind.STATIC_ASSERT}
INDEXED_NAMESPACES = {"Eigen", "cv"}


class Unparsed(Exception):
    """Clang does not understand a source: its places would be guesses."""


def grown(text):
    """The literal that takes the place of a number, or None where it is no plain number."""
    if real := re.fullmatch(r"((?:[\d']+\.[\d']*|\.[\d']+)(?:[eE][+-]?\d+)?|[\d']+[eE][+-]?\d+)([fFlL]?)", text):
        value = decimal.Decimal(real.group(1).replace("'", ""))
        if value == 0:
            return "1.0" + real.group(2)
        value = (value * decimal.Decimal("1.25")).normalize()
        plain = f"{value:f}" if -5 <= value.adjusted() < 9 else f"{value:e}"
        return plain + ("" if "." in plain or "e" in plain else ".0") + real.group(2)
    if whole := re.fullmatch(r"(0[xX][\da-fA-F']+|0|[1-9][\d']*)([uUlLzZ]*)", text):
        return str(int(whole.group(1).replace("'", ""), 0) + 1) + whole.group(2)
    return None


class Surroundings:
    """What the parser tells of a source beyond its tokens: which stretches belong to what."""

    def __init__(self, unit, path):
        self.path = path
        self.named, self.excluded, self.indices = [], [], set()
        for child in unit.cursor.get_children():
            if child.location.file and child.location.file.name == path:
                self.walk(child, at_namespace=True)

    def walk(self, cursor, at_namespace):
        start, end = cursor.extent.start.offset, cursor.extent.end.offset
        if cursor.kind in EXCLUDED:
            self.excluded.append((start, end))
        elif cursor.kind in NAMED or (cursor.kind == Kind.VAR_DECL and at_namespace):
            self.named.append((start, end, re.sub(r"<.*>", "", cursor.spelling)))
        elif cursor.kind == Kind.CALL_EXPR and indexes(cursor):
            self.indices.update((a.extent.start.offset, a.extent.end.offset) for a in cursor.get_arguments() if a)
        for child in cursor.get_children():
            self.walk(child, cursor.kind == Kind.NAMESPACE)

    def inside(self, offset):
        """Name of the innermost function, type or constant around a place."""
        around = [(end - start, name) for start, end, name in self.named if start <= offset < end]
        return min(around)[1] if around else "file"

    def is_excluded(self, offset):
        return any(start <= offset < end for start, end in self.excluded)


def indexes(call):
    """Is it a member of Eigen or OpenCV, or any subscript?"""
    if call.spelling == "operator[]":
        return True
    scope = call.referenced.semantic_parent if call.referenced else None
    while scope is not None and scope.kind != Kind.TRANSLATION_UNIT:
        if scope.kind == Kind.NAMESPACE and scope.spelling in INDEXED_NAMESPACES:
            return True
        scope = scope.semantic_parent
    return False


def is_operator(token, before):
    """Does this token do something, rather than name a function or bracket the arguments of a template?"""
    cursor = token.cursor
    if before == "operator":
        return False
    return cursor.kind in OPERATOR_CURSORS or (
        cursor.kind == Kind.DECL_REF_EXPR and cursor.spelling.startswith("operator"))


def is_unary(before):
    return not (before in (")", "]", "}", "this") or re.match(r"[\w.'\"]", before) and before not in ("return", "case"))


def puts_of(token, before, after, surroundings):
    """What can take the place of a token; nothing where the rule leaves it alone."""
    text, cursor = token.spelling, token.cursor
    if cursor.kind in (Kind.FLOATING_LITERAL, Kind.INTEGER_LITERAL) and cursor.extent == token.extent:
        extent = (token.extent.start.offset, token.extent.end.offset)
        index = cursor.kind == Kind.INTEGER_LITERAL and (extent in surroundings.indices or (before, after) == ("[", "]"))
        put = None if index else grown(text)
        return (put,) if put else ()
    if cursor.kind == Kind.CXX_BOOL_LITERAL_EXPR:
        return SWAPPED[text]
    if text not in OPERATORS or not is_operator(token, before):
        return ()
    if text in ("+", "-") and is_unary(before):
        return ("",) if text == "-" else ()
    if text in SIGNS and "basic_string" in cursor.type.spelling:
        return ()
    return OPERATORS[text]


def bracket_depth(depth, token, before):
    """How many lists of template arguments are open behind a token."""
    text = token.spelling
    if text in (";", "{"):
        return 0
    if text not in ("<", ">", ">>") or is_operator(token, before) or before == "operator":
        return depth
    return depth + 1 if text == "<" else max(0, depth - len(text))


def find(path, shown, arguments, text=None):
    """All places of a source, in its order. `shown` is its name in the results; `text` stands in for its content."""
    unsaved = [(path, text)] if text is not None else None
    unit = cindex.Index.create().parse(path, args=arguments, unsaved_files=unsaved)
    if errors := [d for d in unit.diagnostics if d.severity >= cindex.Diagnostic.Error]:
        raise Unparsed(f"{shown}: {errors[0].spelling}")
    surroundings = Surroundings(unit, path)
    tokens = [t for t in unit.get_tokens(extent=unit.cursor.extent) if t.kind != cindex.TokenKind.COMMENT]
    spellings = [""] + [t.spelling for t in tokens] + [""]
    places, seen, depth = [], collections.Counter(), 0
    for i, token in enumerate(tokens):
        before, after, offset = spellings[i], spellings[i + 2], token.extent.start.offset
        depth = bracket_depth(depth, token, before)
        puts = puts_of(token, before, after, surroundings)
        if not puts or depth > 0 or surroundings.is_excluded(offset):
            continue
        inside = surroundings.inside(offset)
        seen[inside, token.spelling] += 1
        slug = f"{WORDS.get(token.spelling, token.spelling)}-{seen[inside, token.spelling]}"
        stem = os.path.splitext(os.path.basename(shown))[0]
        places.append(Place(shown, offset, token.spelling, puts, token.location.line, inside, f"{stem}.{inside}.{slug}"))
    return places


def sources(root, folders):
    """All .cpp files of these folders of the tree, in a fixed order."""
    found = []
    for folder in folders:
        found += glob.glob(os.path.join(root, folder, "**", "*.cpp"), recursive=True)
    return sorted(os.path.relpath(path, root) for path in found)
