#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Writes a DXF of lines, polylines, circles and arcs again, as CF2 or PDF. Has nothing of the readers under test.

    redraw.py IN.dxf OUT.cf2|OUT.pdf [scale [x_mm y_mm]] [inch] [steps] [sub] [cairo]

steps: processing steps of ISO 19593-1 in place of spot colours; cairo: plain colours, by cairo's own writer; sub: the
drawing is a SUB, which MAIN places; inch: a CF2 in inches.
"""
import math
import sys
import zlib

TYPES = {'CUT': 1, 'CREASE': 2, 'PERF': 3, 'HALFCUT': 4}
SPOTS = {'CUT': ('Dieline', '0 1 1 0'), 'CREASE': ('Crease', '1 0 0 0'), 'PERF': ('Perforation', '0 0 1 0'),
         'HALFCUT': ('Kiss#20Cut', '0 1 0 0')}
STEPS = {'CUT': 'Cutting', 'CREASE': 'Creasing', 'PERF': 'Perforating', 'HALFCUT': 'PartialCutting'}
COLOURS = {'CUT': (1, 0, 0), 'CREASE': (0, 0, 1), 'PERF': (0, 1, 1), 'HALFCUT': (1, 0, 1)}
POINT = 72 / 25.4


def entities(path):
    """Yields (layer, kind, values): ('line', p, q) or ('arc', centre, radius, from, sweep), in mm and radians."""
    lines = open(path, encoding='utf-8').read().splitlines()
    tags = [(int(lines[i]), lines[i + 1].strip()) for i in range(0, len(lines) - 1, 2)]
    groups = []
    section = ''
    for code, value in tags:
        if code == 2 and groups and groups[-1][0][1] == 'SECTION':
            section = value
        if code == 0:
            groups.append([(code, value)])
        if section == 'ENTITIES' and groups:
            groups[-1].append((code, value))
    for group in groups:
        of = {}
        for code, value in group[1:]:
            of.setdefault(code, []).append(value)
        number = lambda code: float(of[code][0])
        kind, layer = group[0][1], of.get(8, ['?'])[0]
        if kind == 'LINE':
            yield layer, 'line', ((number(10), number(20)), (number(11), number(21)))
        elif kind == 'CIRCLE':
            yield layer, 'arc', ((number(10), number(20)), number(40), 0.0, 2 * math.pi)
        elif kind == 'ARC':
            start, end = math.radians(number(50)), math.radians(number(51))
            yield layer, 'arc', ((number(10), number(20)), number(40), start, (end - start) % (2 * math.pi))
        elif kind == 'LWPOLYLINE':
            yield from ((layer, *piece) for piece in polyline(group, int(number(70))))


def polyline(group, flags):
    points = []
    for code, value in group:
        if code == 10:
            points.append([float(value), 0.0, 0.0])
        elif code in (20, 42) and points:
            points[-1][1 if code == 20 else 2] = float(value)
    if flags & 1:
        points.append(points[0])
    for (x0, y0, b), (x1, y1, _) in zip(points, points[1:]):
        if b == 0.0:
            yield 'line', ((x0, y0), (x1, y1))
            continue
        # b is the tangent of a quarter of the sweep; the centre lies on the chord's bisector.
        sweep = 4 * math.atan(b)
        half = math.hypot(x1 - x0, y1 - y0) / 2
        away = half / math.tan(sweep / 2)
        ux, uy = (x1 - x0) / (2 * half), (y1 - y0) / (2 * half)
        cx, cy = (x0 + x1) / 2 - uy * away, (y0 + y1) / 2 + ux * away
        yield 'arc', ((cx, cy), half / abs(math.sin(sweep / 2)), math.atan2(y0 - cy, x0 - cx), sweep)


def on_circle(centre, radius, angle):
    return centre[0] + radius * math.cos(angle), centre[1] + radius * math.sin(angle)


def cf2(drawing, options):
    unit = 25.4 if 'inch' in options else 1.0
    text = lambda *values: ','.join(f'{v / unit:.9f}' for v in values)
    body = []
    for layer, kind, values in drawing:
        rule = f'2,{TYPES[layer]},0,'
        if kind == 'line':
            body.append('L,' + rule + text(*values[0], *values[1]) + ',0,0')
        else:
            centre, radius, start, sweep = values
            ends = on_circle(centre, radius, start) + on_circle(centre, radius, start + sweep)
            body.append('A,' + rule + text(*ends, *centre) + f',{1 if sweep > 0 else -1},2,0.8')
    head = ['$BOF', 'V2', 'ORDER', '%1:A customer', 'END', 'MAIN,CARTON', 'UI' if 'inch' in options else 'UM',
            'LL,-1000,-1000', 'UR,1000,1000', 'SCALE,1,1']
    if 'sub' in options:
        # Drawn a quarter turn away and mirrored, and placed so that it comes out as it was.
        turned = []
        for line in body:
            f = line.split(',')
            for i in range(4, 8 if f[0] == 'L' else 10, 2):
                f[i], f[i + 1] = f[i + 1], f[i]
            if f[0] == 'A':
                f[10] = str(-int(f[10]))
            turned.append(','.join(f))
        return head + ['C,ONE,0,0,90,1,-1', 'END', 'SUB,ONE'] + turned + ['END', '$EOF']
    return head + body + ['END', '$EOF']


def beziers(values):
    """Pieces of no more than a sixteenth of a turn: 1e-8 of the radius off."""
    centre, radius, start, sweep = values
    count = math.ceil(abs(sweep) / (math.pi / 8) - 1e-9)
    step = sweep / count
    k = 4 / 3 * math.tan(step / 4) * radius
    for i in range(count):
        a, b = start + i * step, start + (i + 1) * step
        p, q = on_circle(centre, radius, a), on_circle(centre, radius, b)
        yield (p, (p[0] - k * math.sin(a), p[1] + k * math.cos(a)),
               (q[0] + k * math.sin(b), q[1] - k * math.cos(b)), q)


def pdf(drawing, size, options):
    text = lambda *points: ' '.join(f'{v * POINT:.7f}' for p in points for v in p)
    content = ['0.25 w 1 J']
    for layer in SPOTS:
        pieces = [(kind, values) for of, kind, values in drawing if of == layer]
        if not pieces:
            continue
        content.append(f'/OC /{layer} BDC' if 'steps' in options else f'/{layer} CS 1 SCN')
        for kind, values in pieces:
            if kind == 'line':
                content.append(f'{text(values[0])} m {text(values[1])} l S')
                continue
            for n, (p, c0, c1, q) in enumerate(beziers(values)):
                content.append(('' if n else f'{text(p)} m ') + f'{text(c0, c1, q)} c')
            content.append('S')
        content.append('EMC' if 'steps' in options else '')
    packed = zlib.compress('\n'.join(content).encode())
    spots = ' '.join(f'/{l} [/Separation /{s} /DeviceCMYK << /FunctionType 2 /Domain [0 1] /N 1 /C0 [0 0 0 0] /C1 [{c}] >>]'
                     for l, (s, c) in SPOTS.items())
    first = 5
    groups = {l: first + i for i, l in enumerate(STEPS)}
    objects = [
        '<< /Type /Catalog /Pages 2 0 R /OCProperties << /OCGs [' + ' '.join(f'{n} 0 R' for n in groups.values())
        + '] /D << /BaseState /ON >> >> >>',
        '<< /Type /Pages /Kids [3 0 R] /Count 1 >>',
        f'<< /Type /Page /Parent 2 0 R /MediaBox [0 0 {size[0] * POINT:.4f} {size[1] * POINT:.4f}] /Contents 4 0 R '
        f'/Resources << /ColorSpace << {spots} >> /Properties << '
        + ' '.join(f'/{l} {n} 0 R' for l, n in groups.items()) + ' >> >> >>',
        packed]
    objects += [f'<< /Type /OCG /Name (layer {n}) /GTS_Metadata << /GTS_ProcStepsGroup /Structural '
                f'/GTS_ProcStepsType /{STEPS[l]} >> >>' for l, n in groups.items()]
    out = bytearray(b'%PDF-1.6\n')
    places = []
    for n, body in enumerate(objects, 1):
        places.append(len(out))
        if isinstance(body, bytes):
            body = (f'<< /Length {len(body)} /Filter /FlateDecode >>\nstream\n').encode() + body + b'\nendstream'
        else:
            body = body.encode()
        out += f'{n} 0 obj\n'.encode() + body + b'\nendobj\n'
    table = len(out)
    out += f'xref\n0 {len(places) + 1}\n0000000000 65535 f \n'.encode()
    for place in places:
        out += f'{place:010d} 00000 n \n'.encode()
    out += f'trailer\n<< /Size {len(places) + 1} /Root 1 0 R >>\nstartxref\n{table}\n%%EOF\n'.encode()
    return bytes(out)


def by_cairo(path, drawing, size):
    import cairo
    surface = cairo.PDFSurface(path, size[0] * POINT, size[1] * POINT)
    context = cairo.Context(surface)
    context.transform(cairo.Matrix(POINT, 0, 0, -POINT, 0, size[1] * POINT))
    context.set_line_width(0.1)
    for layer, kind, values in drawing:
        context.set_source_rgb(*COLOURS[layer])
        if kind == 'line':
            context.move_to(*values[0])
            context.line_to(*values[1])
        else:
            for n, (p, c0, c1, q) in enumerate(beziers(values)):
                if n == 0:
                    context.move_to(*p)
                context.curve_to(*c0, *c1, *q)
        context.stroke()
    surface.finish()


def main():
    source, target, *options = sys.argv[1:]
    numbers = [float(o) for o in options if o.replace('.', '').replace('-', '').isdigit()]
    scale, dx, dy = (numbers + [1.0, 0.0, 0.0][len(numbers):])[:3]
    place = lambda p: (scale * p[0] + dx, scale * p[1] + dy)
    drawing = []
    for layer, kind, values in entities(source):
        if kind == 'line':
            drawing.append((layer, kind, tuple(place(p) for p in values)))
        else:
            drawing.append((layer, kind, (place(values[0]), scale * values[1], *values[2:])))
    size = (200.0, 200.0)
    if target.endswith('.cf2'):
        with open(target, 'w', encoding='ascii', newline='\r\n') as file:
            file.write('\n'.join(cf2(drawing, options)) + '\n')
    elif 'cairo' in options:
        by_cairo(target, drawing, size)
    else:
        with open(target, 'wb') as file:
            file.write(pdf(drawing, size, options))


if __name__ == '__main__':
    main()
