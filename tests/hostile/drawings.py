# SPDX-License-Identifier: Apache-2.0
"""Drawings, contours and G-code that are made to take time, memory, files or the terminal."""
from cases import MIB, SECRET, Case, deflated, streams, writes
from readers import pdf

LARGE = (20.0, 1024 * MIB)  # A sound drawing of that size may take it.


def dxf(entities, blocks=""):
    return (f"0\nSECTION\n2\nHEADER\n9\n$INSUNITS\n70\n4\n0\nENDSEC\n0\nSECTION\n2\nBLOCKS\n{blocks}0\nENDSEC\n"
            f"0\nSECTION\n2\nENTITIES\n{entities}0\nENDSEC\n0\nEOF\n")


def line(x, y, u, v, layer="cut"):
    return f"0\nLINE\n8\n{layer}\n10\n{x}\n20\n{y}\n11\n{u}\n21\n{v}\n"


def block(name, content):
    return f"0\nBLOCK\n8\n0\n2\n{name}\n10\n0\n20\n0\n{content}0\nENDBLK\n8\n0\n"


def insert(name, more=""):
    return f"0\nINSERT\n8\ncut\n2\n{name}\n10\n0\n20\n0\n{more}"


def chain(levels, width):
    """Blocks that insert each other: width to the power of levels lines."""
    blocks = block("B0", line(0, 0, 1, 1))
    for level in range(1, levels + 1):
        blocks += block(f"B{level}", insert(f"B{level - 1}") * width)
    return dxf(insert(f"B{levels}"), blocks)


def svg(content, head=""):
    return (f'<?xml version="1.0"?>\n{head}<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink" '
            f'width="100mm" height="100mm" viewBox="0 0 100 100">{content}</svg>\n')


PATH = '<path id="p" class="a" style="fill:none;stroke:#ff0000" d="M 0 0 L 10 10"/>'


def uses(levels, width):
    content = f'<defs><g id="u0">{PATH}</g>'
    for level in range(1, levels + 1):
        content += f'<g id="u{level}">' + f'<use xlink:href="#u{level - 1}"/>' * width + "</g>"
    return svg(content + f'</defs><use xlink:href="#u{levels}"/>')


def many(count, shape):
    """A drawing of so many lines, a piece at a time."""
    def pieces():
        begin, end = dxf("\0").split("\0")
        yield begin
        for i in range(count):
            yield line(*shape(i))
        yield end
    return pieces


def dxf_cases():
    huge = "9" * 400
    return [
        Case("dxf", "INSERT of itself", writes(dxf(insert("A"), block("A", insert("A")))), group="amplification", quick=True),
        Case("dxf", "INSERT 10 to the power of 9", writes(chain(9, 10)), group="amplification", quick=True),
        Case("dxf", "INSERT 300 deep", writes(chain(300, 1)), group="deep nesting"),
        Case("dxf", "INSERT in 30000 x 30000 rows", writes(dxf(insert("A", "70\n30000\n71\n30000\n44\n1\n45\n1\n"),
             block("A", line(0, 0, 1, 1)))), group="amplification"),
        Case("dxf", "INSERT in -1 rows", writes(dxf(insert("A", "70\n-1\n71\n-5\n"), block("A", line(0, 0, 1, 1)))), group="counts"),
        Case("dxf", "not a number", writes(dxf(line("nan", 0, "inf", 1))), group="numbers", quick=True),
        Case("dxf", "1e308", writes(dxf(line("1e308", "-1e308", "-1e308", "1e308"))), group="numbers"),
        Case("dxf", "400 digits", writes(dxf(line(huge, 0, "1e999999", 1))), group="numbers"),
        Case("dxf", "polyline of 4 000 000 000 vertices", writes(dxf("0\nLWPOLYLINE\n8\ncut\n90\n4000000000\n70\n1\n10\n0\n20\n0\n")),
             group="counts"),
        Case("dxf", "spline of -5 knots", writes(dxf("0\nSPLINE\n8\ncut\n70\n8\n71\n3\n72\n-5\n73\n99999999999\n40\n0\n")), group="counts"),
        Case("dxf", "spline of degree 10^9", writes(dxf("0\nSPLINE\n8\ncut\n71\n1000000000\n72\n4\n73\n2\n40\n0\n40\n0\n10\n0\n20\n0\n")),
             group="counts"),
        Case("dxf", "layer with escape sequences", writes(dxf(line(0, 0, 9, 9, "\x1b]0;x\x07\x1b[31mKNIFE\u009b2J"))), group="terminal",
             quick=True),
        Case("dxf", "layer of 1 MiB", writes(dxf(line(0, 0, 9, 9, "L" * MIB))), group="long lines"),
        Case("dxf", "layer with a workflow command", writes(dxf(line(0, 0, 9, 9, "::set-output name=a::b ##[add-mask]x"))), group="terminal"),
        Case("dxf", "10^5 lines on each other", streams(many(100_000, lambda i: (0, 0, 10, 0))), group="entities", honest=LARGE),
        Case("dxf", "10^5 lines apart", streams(many(100_000, lambda i: (0, i, 5, i))), group="entities", honest=LARGE),
        Case("dxf", "10^5 lines through a point", streams(many(100_000, lambda i: (-i, -99999, i, 99999))), group="entities",
             honest=LARGE),
        Case("dxf", "10^5 layers", streams(many(100_000, lambda i: (0, i, 5, i, f"layer {i}"))), group="entities", honest=LARGE),
        Case("dxf", "10^5 unknown entities", writes(dxf("".join(f"0\nFOO{i}\n8\ncut\n" for i in range(100_000)))), group="entities"),
        Case("dxf", "binary DXF", writes(b"AutoCAD Binary DXF\r\n\x1a\0" + bytes(200)), group="wrong magic"),
        Case("dxf", "text behind the end", writes(dxf(line(0, 0, 9, 9)) + "x\n" * 100_000), group="wrong magic"),
        Case("dxf", "name of 250 letters", writes(dxf(line(0, 0, 9, 9))), name="n" * 250, group="names"),
    ]


def svg_cases():
    laughs = '<!DOCTYPE svg [<!ENTITY a0 "ha">' + "".join(
        f'<!ENTITY a{i} "{f"&a{i - 1};" * 10}">' for i in range(1, 10)) + "]>"
    steal = f'<!DOCTYPE svg [<!ENTITY x SYSTEM "file:///etc/passwd"><!ENTITY y SYSTEM "secret.txt">]>'

    def with_secret(path, draw):
        writes(svg(f"<text>&x;&y;</text>{PATH}", steal))(path, draw)
        (path.parent / "secret.txt").write_text(SECRET)
    style = "<style>" + "".join(f".a{i}{{stroke:#ff0000}}" for i in range(50_000)) + "</style>"
    return [
        Case("svg", "entities of entities (billion laughs)", writes(svg(f"<text>&a9;</text>{PATH}", laughs)), group="amplification", quick=True),
        Case("svg", "external entity", with_secret, group="foreign", secret=SECRET, quick=True),
        Case("svg", "use of itself", writes(svg('<use id="a" xlink:href="#a"/>')), group="amplification", quick=True),
        Case("svg", "use 10 to the power of 9", writes(uses(9, 10)), group="amplification", quick=True),
        Case("svg", "use of an empty group 8 to the power of 12", writes(uses(12, 8).replace(PATH, "")), group="amplification"),
        Case("svg", "use of groups without lines, 40 kB", writes(uses(6, 160).replace(PATH, "<desc/>")), group="amplification"),
        Case("svg", "use of what has 10^5 attributes", writes(svg(
            "<defs><g id='a' " + " ".join(f"x{i}='1'" for i in range(100_000)) + f">{PATH}</g></defs>" + "<use xlink:href='#a'/>" * 2000)),
            group="amplification"),
        Case("svg", "50 000 classes, 20 000 elements", writes(svg(style + '<path class="a1 a2 a3" d="M 0 0"/>' * 20_000)), group="amplification"),
        Case("svg", "class of 10^5 words on 500 elements", writes(svg(
            "<style>.w1{fill:none;stroke:#f00}</style>" + f'<path class="{"w1 " * 10_000}" d="M 0 0 L 1 1"/>' * 50)), group="amplification"),
        Case("svg", "style of 500 rules times 1000 selectors", writes(svg(
            "<style>" + (",".join(f".s{i}" for i in range(1000)) + "{stroke:#ff0000}") * 500 + "</style>" + PATH)), group="amplification"),
        Case("svg", "100 000 groups deep", writes(svg("<g>" * 100_000 + PATH + "</g>" * 100_000)), group="deep nesting", quick=True),
        Case("svg", "10^5 open parentheses of transform", writes(svg(f'<g transform="{"scale(" * 100_000}">{PATH}</g>')), group="deep nesting"),
        Case("svg", "10^5 transforms", writes(svg(f'<g transform="{"scale(2) " * 100_000}">{PATH}</g>')), group="numbers"),
        Case("svg", "not a number", writes(svg(PATH.replace("10 10", "nan inf"))), group="numbers"),
        Case("svg", "1e999", writes(svg(PATH.replace("10 10", "1e999 -1e308"))), group="numbers"),
        Case("svg", "arc of radius 1e300", writes(svg(PATH.replace("L 10 10", "A 1e300 1e-300 0 1 1 10 10"))), group="numbers"),
        Case("svg", "view box of zero", writes(svg(PATH).replace("0 0 100 100", "0 0 0 0")), group="numbers"),
        Case("svg", "path of 10^5 curves", writes(svg(PATH.replace("L 10 10", "C 1 2 3 4 5 6 " * 100_000))), group="entities", honest=LARGE),
        Case("svg", "external image and style sheet", writes(svg(
            '<image xlink:href="file:///etc/passwd"/><style>@import url("file:///etc/passwd");</style>' + PATH)), group="foreign"),
        Case("svg", "use of a file", writes(svg('<use xlink:href="/etc/passwd#a"/>')), group="foreign"),
        Case("svg", "colours with escape sequences", writes(svg(PATH.replace("#ff0000", "&#x9b;31m\u009b2J"))), group="terminal", quick=True),
        Case("svg", "script", writes(svg(f'<script>alert(1)</script><g onload="alert(1)">{PATH}</g>')), group="terminal"),
        Case("svg", "comment that never ends", writes(svg("<!--" + "-" * MIB)), group="truncated"),
    ]


def other_cases():
    subs = "".join(f"SUB,S{i}\n" + f"C,S{i - 1},0,0,0,1,1\n" * 10 + "END\n" for i in range(1, 10))
    cf2 = "$BOF\nV2\nORDER\nEND\nMAIN,M\nUM\nLL,0,0\nUR,9,9\nSCALE,1,1\n{}END\n{}$EOF\n"

    def flate():
        return pdf(deflated(b"0 0 m 1 1 l S\n" * 20_000, 1000)).replace(b"<</Length", b"<</Filter/FlateDecode/Length", 1)

    def twice():
        bomb = deflated(deflated(b"0 0 m 1 1 l S\n" * 20_000, 1000), 1)
        return pdf(bomb).replace(b"<</Length", b"<</Filter[/FlateDecode/FlateDecode]/Length", 1)
    return [
        Case("cf2", "C of itself", writes(cf2.format("C,A,0,0,0,1,1\n", "SUB,A\nC,A,0,0,0,1,1\nEND\n")), group="amplification"),
        Case("cf2", "copies 10 to the power of 9", writes(cf2.format("C,S9,0,0,0,1,1\n", "SUB,S0\nL,2,1,0,0,0,1,1,0,0\nEND\n" + subs)),
             group="amplification", quick=True),
        Case("cf2", "not a number", writes(cf2.format("L,2,1,0,nan,inf,1e999,5,0,0\n", "")), group="numbers"),
        Case("cf2", "scale of zero", writes(cf2.format("L,2,1,0,0,0,5,5,0,0\n", "").replace("SCALE,1,1", "SCALE,0,0")), group="numbers"),
        Case("cf2", "type with escape sequences", writes(cf2.format("L,2,\x1b[31m,0,0,0,5,5,0,0\n", "")), group="terminal"),
        Case("pdf", "zip bomb", writes(flate), group="amplification"),
        Case("pdf", "zip bomb in a zip bomb", writes(twice), group="amplification"),
        Case("pdf", "page tree that is its own child", writes(pdf(b"0 0 m 1 1 l S").replace(b"/Kids[3 0 R]", b"/Kids[2 0 R]")), group="deep nesting"),
        Case("pdf", "-1 pages", writes(pdf(b"0 0 m 1 1 l S", -1)), group="counts"),
        Case("pdf", "10^9 pages", writes(pdf(b"0 0 m 1 1 l S", 10**9)), group="counts"),
        Case("pdf", "10^5 saved states", writes(pdf(b"q " * 100_000 + b"0 0 m 1 1 l S")), group="deep nesting"),
        Case("pdf", "arrays 10^5 deep", writes(pdf(b"[" * 100_000)), group="deep nesting"),
        Case("pdf", "numbers beyond all", writes(pdf(b"1e999 99999999999999999999999 m 1 1 l S")), group="numbers"),
        Case("xyz", "not a number", writes("0 0 0 0 0 1\nnan inf 0 0 0 1\n1e999 0 0 0 0 1\n"), group="numbers"),
        Case("xyz", "10^5 points", writes("".join(f"{i} 0 0 0 0 1\n" for i in range(100_000))), group="entities", honest=LARGE),
        Case("xyz", "arc of 1e9 mm", writes("0 0 0 0 0 1\ncentre 1e9 0 0 359\n0 0 0 0 0 1\n"), group="numbers"),
        Case("gcode", "not a number", writes("G00 Xnan Yinf\nG01 X1e999 Y-1e308\n"), group="numbers", quick=True),
        Case("gcode", "arc of 1e15 mm", writes("G00 X0 Y0\nG01 Z1\nG02 X0 Y0 I1e15 J0\n"), group="numbers"),
        Case("gcode", "arc whose radii part", writes("G00 X0 Y0\nG02 X50 Y50 I1 J1e-9\n"), group="numbers"),
        Case("gcode", "10^5 lines", writes("G00 X0 Y0 Z0\n" + "".join(f"G01 X{i % 50} Y{i % 7} Z1\n" for i in range(100_000))), group="entities",
             honest=LARGE),
        Case("gcode", "10^6 comments open", writes("(" * 1_000_000), group="deep nesting"),
        Case("gcode", "comment with escape sequences", writes("(\x1b]0;x\x07\x1b[2J)\nG99 X1\n\x9b31m\n"), group="terminal"),
        Case("gcode", "line number 10^30", writes("N" + "9" * 30 + " G01 X1\n"), group="numbers"),
    ]
